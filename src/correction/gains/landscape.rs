//! The objective of the gains as a function of the scales that the held products leave free.

use super::problem::{GainObjective, GainProblem};
use crate::correction::components::Components;
use crate::correction::scales::{Entry, Gather, Landscape, Link, Shape, Sum, parabolas, product_roundings};

/// `(20 / ln 10)^2`: squared dB in a squared natural logarithm.
pub(crate) const SQUARED_DECIBEL: f64 = (20.0 / std::f64::consts::LN_10) * (20.0 / std::f64::consts::LN_10);

/// One entry of the objective: `share (wanted - product e^u)^2`, or its counterpart in logarithms.
struct Term {
    output_component: usize,
    input_component: usize,
    share: f64,
    wanted: f64,
    /// Logarithm of the product where both scales are 0.
    offset: f64,
}

/// The landscape of `problem` over the scales of `components`.
pub(crate) fn landscape(problem: &GainProblem, components: &Components) -> Landscape {
    let ground = components.count();
    let fit = problem.fit_entries().map(|(pair, wanted)| {
        let (output, input) = (components.outputs[pair.output], components.inputs[pair.input]);
        Term {
            output_component: output.component,
            input_component: input.component,
            share: 1.0,
            wanted,
            offset: output.offset + input.offset,
        }
    });
    let departure = components.outputs.iter().filter(|_| problem.alpha > 0.0).map(|output| Term {
        output_component: output.component,
        input_component: ground,
        share: problem.alpha,
        wanted: 1.0,
        offset: output.offset,
    });
    let terms: Vec<Term> = fit.chain(departure).collect();
    let (links, constant) = match problem.objective {
        GainObjective::Ratio => ratio_links(&terms, ground),
        GainObjective::Decibel => decibel_links(&terms, ground),
    };
    let (mut lower, mut upper) = (components.lower.clone(), components.upper.clone());
    lower.push(0.0);
    upper.push(0.0);
    Landscape { lower, upper, links, constant }
}

/// One link for each two nodes that share an entry: `forward` holds the entries whose input has the greater index.
fn ratio_links(terms: &[Term], ground: usize) -> (Vec<Link>, Sum) {
    let nodes = ground + 1;
    let mut gathered: Vec<Gather> = vec![Gather::default(); nodes * nodes];
    let mut constant = Sum::default();
    for term in terms {
        if term.output_component == term.input_component {
            let product = term.offset.exp();
            let roundings = product_roundings(term.offset);
            constant.add(term.share, term.wanted - product, term.wanted + product, roundings);
        } else {
            let group = &mut gathered[term.output_component * nodes + term.input_component];
            group.add(term.share, term.wanted, term.offset);
        }
    }
    let mut links = Vec::new();
    for from in 0..nodes {
        for to in from + 1..nodes {
            let (forward, ahead) = gathered[from * nodes + to].well();
            let (backward, behind) = gathered[to * nodes + from].well();
            constant.join(ahead);
            constant.join(behind);
            if !(forward.is_flat() && backward.is_flat()) {
                links.push(Link { from, to, shape: Shape::wells(forward, backward) });
            }
        }
    }
    (links, constant)
}

fn decibel_links(terms: &[Term], ground: usize) -> (Vec<Link>, Sum) {
    let entry = |term: &Term| Entry {
        output: term.output_component,
        input: term.input_component,
        share: SQUARED_DECIBEL * term.share,
        wanted: term.wanted.ln(),
        offset: term.offset,
    };
    parabolas(&terms.iter().map(entry).collect::<Vec<_>>(), ground + 1)
}
