//! The engineer's rules for the files in a folder: channels, conversions, signs and values for
//! single models. Rules and files together determine the dataset.

use std::collections::BTreeMap;

use super::declarations::{
    ChannelDeclarations, ModelDeclarations, ScopedDeclarations, Signs, UnitRule,
    applicable_declarations, rename_key,
};
use super::file_scope::FileScope;
use super::found_model::FoundModel;
use super::row_rule::RowRule;
use crate::dataset::PhysicsParameter;
use crate::dataset::channel::ChannelSide;
use crate::names::on_axis::is_standard_on_axis;
use crate::names::{ChannelRule, NamePattern, RowRole, standard_patterns};

/// Column headings by file: "omega \[rad/s\]", "mag P/LAT \[dB\]".
pub type Headings = BTreeMap<String, Vec<String>>;

/// The engineer's rules for the files in a folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    pub name: String,
    /// Content and source of the data.
    pub description: String,
    /// Inputs in the dataset's order.
    pub inputs: Vec<ChannelRule>,
    /// Outputs in the dataset's order.
    pub outputs: Vec<ChannelRule>,
    /// On-axis responses: output name and input name.
    pub on_axis: Vec<(String, String)>,
    /// Comparison band, lower and upper end \[rad/s\].
    pub band: (f64, f64),
    /// Named physics model parameters, with the changes that are plausible (M18.1).
    pub parameters: Vec<PhysicsParameter>,
    /// Patterns for folder, file and variable names; earlier patterns take precedence.
    pub patterns: Vec<NamePattern>,
    /// Factors between units without a fixed ratio.
    pub units: Vec<UnitRule>,
    /// Sign factors for all files, 1 or -1; they override sign marks in names. This map,
    /// `role_signs` and `declarations` are separate keys in a rules file, and all three may give a
    /// sign; [`Self::declared`] merges them.
    pub signs: Signs,
    /// Sign factors by role, "identified" or "physics"; they override `signs`.
    pub role_signs: BTreeMap<String, Signs>,
    /// Units, factors and signs for the models in a scope: a role, a folder or a file.
    pub declarations: Vec<ScopedDeclarations>,
    /// Sample time \[s\] for files that give none, 0 for continuous time; `None` if unknown.
    pub sample_time_s: Option<f64>,
    /// Column headings; they replace the headings in the files.
    pub headings: Headings,
    /// Values for single models, by [`FoundModel::key`].
    pub rows: BTreeMap<String, RowRule>,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            name: String::new(),
            description: String::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            on_axis: Vec::new(),
            // Usual comparison band for helicopter rigid-body responses.
            band: (0.5, 12.0),
            parameters: Vec::new(),
            patterns: standard_patterns().to_vec(),
            units: Vec::new(),
            signs: Signs::new(),
            role_signs: BTreeMap::new(),
            declarations: Vec::new(),
            sample_time_s: None,
            headings: Headings::new(),
            rows: BTreeMap::new(),
        }
    }
}

impl Rules {
    /// Returns the dataset's inputs or outputs.
    pub fn channels_mut(&mut self, side: ChannelSide) -> &mut Vec<ChannelRule> {
        side.pick(&mut self.inputs, &mut self.outputs)
    }

    /// Renames a dataset channel.
    ///
    /// 1. The old name becomes an alias.
    /// 2. On-axis responses are renamed, and those that are on-axis by convention under the new
    ///    name are added.
    /// 3. Conversions, values for single models, signs and declarations are renamed.
    ///
    /// Does nothing for a missing index or an unchanged name.
    pub fn rename(&mut self, side: ChannelSide, index: usize, name: String) {
        let Some(channel) = self.channels_mut(side).get_mut(index) else {
            return;
        };
        let old = std::mem::replace(&mut channel.name, name.clone());
        if old == name {
            return;
        }
        // Step 1.
        channel.aliases.retain(|alias| *alias != name);
        if !old.is_empty() && !channel.aliases.contains(&old) {
            channel.aliases.push(old.clone());
        }
        // Step 2.
        for (output, input) in &mut self.on_axis {
            let on_side = side.pick(input, output);
            if *on_side == old {
                on_side.clone_from(&name);
            }
        }
        self.mark_standard_on_axis(side, &name);
        // Step 3.
        for unit in &mut self.units {
            if unit.channel == old {
                unit.channel.clone_from(&name);
            }
        }
        for row in self.rows.values_mut() {
            row.rename_channel(&old, &name);
        }
        rename_key(&mut self.signs, &old, &name);
        for signs in self.role_signs.values_mut() {
            rename_key(signs, &old, &name);
        }
        for declared in &mut self.declarations {
            declared.channels.rename(&old, &name);
        }
    }

    /// Adds the channel's responses that are on-axis by convention to the on-axis responses.
    fn mark_standard_on_axis(&mut self, side: ChannelSide, name: &str) {
        for other in side.pick(&self.outputs, &self.inputs) {
            let [output, input] = match side {
                ChannelSide::Input => [&other.name, name],
                ChannelSide::Output => [name, &other.name],
            };
            let response = (output.to_owned(), input.to_owned());
            if is_standard_on_axis(output, input) && !self.on_axis.contains(&response) {
                self.on_axis.push(response);
            }
        }
    }

    /// Returns the units, factors and signs that apply to a model's channels. Declarations override
    /// one another in this order, from the lowest precedence: for all models, for a role, for a
    /// folder or pattern, for a file, in the model's own [`RowRule`].
    pub fn declared(&self, found: &FoundModel, role: Option<RowRole>) -> ModelDeclarations<'_> {
        let mut declarations = vec![signs_in_scope(FileScope::All, &self.signs)];
        for (role, signs) in &self.role_signs {
            declarations.push(signs_in_scope(FileScope::from(role.clone()), signs));
        }
        declarations.extend_from_slice(&self.declarations);
        let mut channels = ChannelDeclarations::default();
        for declared in applicable_declarations(&declarations, found, role) {
            channels.override_by(&declared.channels);
        }
        if let Some(row) = self.rows.get(&found.key()) {
            channels.override_by(&row.declarations());
        }
        ModelDeclarations {
            conversions: &self.units,
            channels,
        }
    }

    /// Adds declarations; they override earlier declarations for the same channels and scope.
    ///
    /// 1. Store all declarations for files or folders in [`Self::declarations`].
    /// 2. Otherwise, store signs in [`Self::signs`] (all models) or [`Self::role_signs`] (a role),
    ///    and units and factors in [`Self::declarations`].
    pub fn declare(&mut self, scope: FileScope, declared: &ChannelDeclarations) {
        // `None` if there are no signs for a role, which then needs no entry in `role_signs`.
        let signs = match &scope {
            FileScope::Files(_) => {
                self.declarations_mut(scope).override_by(declared);
                return;
            }
            FileScope::All => Some(&mut self.signs),
            FileScope::Physics | FileScope::Identified if declared.signs.is_empty() => None,
            FileScope::Physics | FileScope::Identified => {
                Some(self.role_signs.entry(scope.to_string()).or_default())
            }
        };
        if let Some(signs) = signs {
            for (channel, sign) in &declared.signs {
                signs.insert(channel.clone(), *sign);
            }
        }
        let conversions = ChannelDeclarations {
            signs: Signs::new(),
            ..declared.clone()
        };
        if conversions != ChannelDeclarations::default() {
            self.declarations_mut(scope).override_by(&conversions);
        }
    }

    /// Returns the declarations for a scope; adds an empty entry if there is none.
    pub fn declarations_mut(&mut self, scope: FileScope) -> &mut ChannelDeclarations {
        let known = self
            .declarations
            .iter()
            .position(|declared| declared.scope == scope);
        let index = match known {
            Some(index) => index,
            None => {
                self.declarations.push(ScopedDeclarations {
                    scope,
                    channels: ChannelDeclarations::default(),
                });
                self.declarations.len() - 1
            }
        };
        &mut self.declarations[index].channels
    }
}

/// Returns declarations that contain only signs.
fn signs_in_scope(scope: FileScope, signs: &Signs) -> ScopedDeclarations {
    ScopedDeclarations {
        scope,
        channels: ChannelDeclarations {
            signs: signs.clone(),
            ..ChannelDeclarations::default()
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_follow_a_renamed_channel() {
        let mut rules = Rules {
            inputs: vec![ChannelRule::named("xb"), ChannelRule::named("COL")],
            outputs: vec![ChannelRule::named("Q"), ChannelRule::named("az")],
            on_axis: vec![("az".into(), "COL".into())],
            units: vec![UnitRule {
                channel: "xb".into(),
                from: "in".into(),
                factor: 8.0,
            }],
            signs: Signs::from([("az".into(), -1.0)]),
            role_signs: BTreeMap::from([("identified".into(), Signs::from([("xb".into(), -1.0)]))]),
            ..Rules::default()
        };
        rules
            .declarations_mut(FileScope::Physics)
            .units
            .insert("xb".into(), "in".into());
        rules.rows.entry("a.mat".into()).or_default().factors =
            Some([("xb".to_owned(), 8.0)].into());
        rules.rename(ChannelSide::Input, 0, "LON".into());
        rules.rename(ChannelSide::Output, 1, "NZ".into());
        assert_eq!(
            rules.on_axis,
            [("NZ", "COL"), ("Q", "LON")]
                .map(|(output, input)| (output.to_owned(), input.to_owned()))
        );
        assert_eq!(rules.inputs[0].aliases, ["xb"]);
        assert_eq!(rules.units[0].channel, "LON");
        assert_eq!(rules.signs, Signs::from([("NZ".into(), -1.0)]));
        assert_eq!(
            rules.role_signs["identified"],
            Signs::from([("LON".into(), -1.0)])
        );
        assert_eq!(
            rules.declarations[0]
                .channels
                .units
                .keys()
                .collect::<Vec<_>>(),
            ["LON"]
        );
        assert_eq!(
            rules.rows["a.mat"]
                .declarations()
                .factors
                .keys()
                .collect::<Vec<_>>(),
            ["LON"]
        );
        let before = rules.clone();
        rules.rename(ChannelSide::Input, 0, "LON".into());
        rules.rename(ChannelSide::Input, 7, "none".into());
        assert_eq!(rules, before);
        rules.rename(ChannelSide::Input, 0, "xb".into());
        assert_eq!(rules.inputs[0].aliases, ["LON"]);
    }
}
