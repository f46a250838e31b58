//! The Gain-Delay Correction Method: gives each channel in a physics-based helicopter model a gain
//! and a delay, so that the model matches flight.
//!
//! Equation numbers refer to "Bridging the Gap: Data Driven Method for Linearized Model Fidelity
//! Enhancement", section numbers (M1, M2, ...) to the pages in `docs/` under
//! [Sections M1 to M18](#sections-m1-to-m18).
//!
//! # The problem
//!
//! A flight condition has a bundle of physics models, linearised at the trim and at perturbed
//! trims, and a bundle with models identified from flight. Each is a p x m frequency response
//!
//! ```text
//! H(j omega) = C (j omega I - A)^-1 B + D.                                                   (M2)
//! ```
//!
//! The corrected physics model has a gain and a delay on every input and every output channel,
//!
//! ```text
//! H^ = M_O H M_I,   M_O = diag(k_o e^(-tau_o s)),   M_I = diag(k_i e^(-tau_i s)),   (eq. 12, M10)
//! ```
//!
//! which multiply the response of output `o` to input `i` by the net gain `k_o k_i` and delay it by
//! `tau_o + tau_i`. Each bundle is represented by its medoid among the models that the engineer
//! keeps (M5). Comparing the two representatives, each response needs
//!
//! ```text
//! G_oi = median |H_ref| / |H_sim|,   D_oi = median Delta phi(H_sim, H_ref) / omega. (eq. 5, 9, M6)
//! ```
//!
//! There are fewer channels than responses, so the gains and the delays are a compromise:
//!
//! ```text
//! min sum w_oi (G_oi - k_o k_i)^2 + alpha sum (k_o - 1)^2                             (eq. 7, M8)
//!     subject to  k_o k_i = G_oi (constrained),  LB <= k <= UB
//! min sum w_oi (D_oi - tau_o - tau_i)^2 + alpha sum tau_o^2                          (eq. 11, M9)
//!     subject to  tau_o + tau_i = D_oi (constrained),  0 <= tau <= UB
//! ```
//!
//! The weight `w_oi` is 1 for a fitted response and 0 for an ignored response. The first problem is
//! not convex; its global minimum is found and proven. Where the constrained values are infeasible,
//! the nearest feasible values replace them, and the result names the entries, the distance and the
//! reason. The cost J measures how well a model matches,
//!
//! ```text
//! J = 20 median(e_dB^2) + 20 * 0.0175 median(e_deg^2),                         (eq. 14-19, M4)
//! ```
//!
//! and the gains at many conditions become a single correction by regressing `ln k` on airspeed
//! (M11).
//!
//! Where a delay cannot help, because the physics model lags, *signed* delays are optional: eq.
//! (11) without `tau >= 0`. A negative delay becomes a filter `L(s)` that acts as a faster servo
//! and has that delay over the band; the gains are then found for the filtered model. `W` is the
//! coherence weight, or 1:
//!
//! ```text
//! D_oi = sum W omega Delta phi / sum W omega^2,                                            (M15)
//! L(s) = (1 + sqrt(2) a s + a^2 s^2) / (1 + sqrt(2) b s + b^2 s^2).
//! ```
//!
//! Couplings and modes, which no gain or delay changes, can be corrected by an input mixing `M~`
//! and a feedback `K` from outputs to inputs, constant over all conditions and found by linear
//! least squares. All steps above then use `H~`, not `H`:
//!
//! ```text
//! H~ = (I - H K)^-1 H M~,   R' = L_o^-1 R L_i^-1 = H (M + K R'),   M~ = M diag(M)^-1.      (M16)
//! ```
//!
//! Models linearised with one named parameter moved show which parameter is wrong, and by how much.
//! Their differences make a family `H(z)`, fitted to all conditions c with free channel gains
//! (logarithms `a_oc` and `b_ic`) and delays:
//!
//! ```text
//! ln R = ln H_oi(z) + a_oc + b_ic - j omega (tau_o + tau_i).                               (M18)
//! ```
//!
//! # Notation
//!
//! | symbol | in code | meaning, unit |
//! |---|---|---|
//! | `p`, `m`, `n`, `N` | `outputs`, `inputs`, `order`, `points` | count of outputs, inputs, states, frequencies |
//! | `omega` | `omega` | angular frequency, rad/s, always |
//! | `H_oi(j omega)` | `values[Pair { output, input }][k]` | response, always `[output, input]` |
//! | `G`, `D` | `Delta::gain`, `Delta::delay_s` | delta gain \[-\], delta delay \[s\] |
//! | `k_o`, `k_i` | `output_gains`, `input_gains` | channel gains \[-\] |
//! | `tau_o`, `tau_i` | `output_delays_s`, `input_delays_s` | channel delays \[s\] |
//! | `tau < 0`, `l`, `a`, `b` | `ChannelLeads`, `lead_s`, `zero_s`, `lag_s` | signed delays, lead time, lead filter time constants \[s\] |
//! | `M~`, `K`, `H~` | `normalised_mixing`, `feedback`, `CouplingMatrices::response` | mixing, feedback, the physics model with both |
//! | `LB`, `UB` | `Bounds` | bounds on the channels |
//! | `alpha` | `alpha_gain`, `alpha_delay` | regularisation weight |
//! | `J`, `Delta J` | `Cost`, `CostChange` | cost, its change; negative is better |
//! | `d(a, b)`, `s_a`, `r_a` | `BundleDistance`, `Representative::scores`, `Discontinuity::ratios` | distance, score, discontinuity ratio |
//! | `V`, `v` | `airspeed_kt`, `Airspeeds::scaled` | true airspeed \[kt\], scaled airspeed \[-\] |
//!
//! # Sections M1 to M18
//!
//! | section | subject | page |
//! |---|---|---|
//! | M1, M2 | data, frequency response | `docs/method.md` |
//! | M3, M4 | phase difference, cost J | `docs/method.md` |
//! | M5 | representatives, outliers, models set aside | `docs/method.md` |
//! | M6, M7 | delta gain and delta delay, bounds | `docs/method.md` |
//! | M8, M9, M10 | gains, delays, corrected model | `docs/method.md` |
//! | M11, M12 | schedule, assessment | `docs/method.md` |
//! | M13 | error bars | `docs/error-bars.md` |
//! | M14 | identified models from flight records | `docs/identification.md` |
//! | M15 | leads | `docs/lead.md` |
//! | M16 | couplings | `docs/couplings.md` |
//! | M17 | requirements | `docs/requirements.md` |
//! | M18 | physics parameters | `docs/physics.md` |
//!
//! # Modules
//!
//! Each module imports only modules above it; a test reads the sources and asserts that.
//!
//! | module | content |
//! |---|---|
//! | [`fidelity`] | cost J, distances in a bundle, representative, discontinuity, mode tracks |
//! | [`correction`] | G, D, bounds, gains, delays, leads, and the corrected model |
//! | [`schedule`] | regression over airspeed, its forms compared, assessment |
//! | [`uncertainty`] | error bars, and the variance split over the conditions |
//! | [`couplings`] | input mixing and output feedback, fitted to all conditions at once (M16) |
//! | [`physics`] | named parameters of the physics model, fitted to all conditions (M18) |
//! | [`requirements`] | bandwidth, time histories, modes, summary costs (M17) |
//!
//! The crate uses no files, windows or threads: a caller with several cores supplies an
//! [`Executor`](gdcm_model::executor::Executor).
//!
//! # Example
//!
//! ```
//! use gdcm_method::correction::solve::solve;
//! use gdcm_method::correction::{Bounds, Problem, ProofBudget};
//! use gdcm_model::dataset::{Pair, PairTable};
//!
//! // Two outputs, two inputs; the response of output 0 to input 0 is to be matched exactly.
//! let delta_gains = [[1.2, 0.8], [0.9, 1.1]];
//! let delta = PairTable::from_fn(2, 2, |pair| Some(delta_gains[pair.output][pair.input]));
//! let constrained = PairTable::from_fn(2, 2, |pair| pair == Pair::new(0, 0));
//! let problem = Problem::gains(delta, constrained, Bounds { lower: 0.5, upper: 2.0 });
//! let solution = solve(&problem, ProofBudget::default(), &|| false)?;
//! assert!((solution.outputs[0] * solution.inputs[0] - 1.2).abs() < 1e-12);
//! # Ok::<(), gdcm_method::correction::problem::ProblemError>(())
//! ```

pub mod correction;
pub mod couplings;
pub mod fidelity;
pub mod physics;
pub mod requirements;
pub mod schedule;
pub mod uncertainty;
