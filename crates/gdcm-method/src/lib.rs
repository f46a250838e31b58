//! The Gain-Delay Correction Method: one gain and one delay for each channel of a physics-based helicopter model, so that it
//! matches flight.
//!
//! # The problem
//!
//! A flight condition has a bundle of physics models, linearised at the trim and at perturbed trims, and a bundle of models
//! identified from flight. Each is a p x m frequency response
//!
//! ```text
//! H(j omega) = C (j omega I - A)^-1 B + D.                                                        (M2)
//! ```
//!
//! The corrected physics model puts a gain and a delay on every input and every output channel,
//!
//! ```text
//! H^ = M_O H M_I,   M_O = diag(k_o e^(-tau_o s)),   M_I = diag(k_i e^(-tau_i s)),                 (eq. 12, M10)
//! ```
//!
//! which multiplies the response of output `o` to input `i` by the net gain `k_o k_i` and delays it by `tau_o + tau_i`. Of the
//! representative models of the two bundles (the medoids among those that the engineer keeps, M5), each response would want
//!
//! ```text
//! G_oi = median |H_ref| / |H_sim|,     D_oi = median Delta phi(H_sim, H_ref) / omega.             (eq. 5, 9, M6)
//! ```
//!
//! There are fewer channels than responses, so the gains and the delays are the optimum of
//!
//! ```text
//! min  sum w_oi (G_oi - k_o k_i)^2 + alpha sum (k_o - 1)^2      s.t.  k_o k_i = G_oi (held),  LB <= k <= UB,     (eq. 7, M8)
//! min  sum w_oi (D_oi - tau_o - tau_i)^2 + alpha sum tau_o^2    s.t.  tau_o + tau_i = D_oi (held),  0 <= tau <= UB.  (eq. 11, M9)
//! ```
//!
//! The first is not convex; its global minimum is found and proven. Where the held values cannot be reached, the nearest that
//! can be are held instead, and the result says which, by how much and why. How well a model matches is its cost
//!
//! ```text
//! J = 20 median(e_dB^2) + 20 * 0.0175 median(e_deg^2),                                            (eq. 14-19, M4)
//! ```
//!
//! and the gains of many conditions become one correction by regressing `ln k` on airspeed (M11). The numbers M1 to M16 are
//! the sections of the method in docs/method.md.
//!
//! Where a delay cannot help, because the physics model lags, the channels get *signed* delays on wish, `tau >= 0` left out of
//! eq. (11); a negative one becomes a filter `L(s)` that acts as a faster servo and has that delay over the band, and the gains are
//! found on what the filters leave:
//!
//! ```text
//! D_oi = sum W omega Delta phi / sum W omega^2,   L(s) = (1 + sqrt(2) a s + a^2 s^2) / (1 + sqrt(2) b s + b^2 s^2).   (M15)
//! ```
//!
//! What no channel reaches, couplings and modes, a mixing `M~` of the inputs and a feedback `K` of outputs to inputs do, constant over
//! all conditions and found by linear least squares; everything above then sees `H~` in place of `H`:
//!
//! ```text
//! H~ = (I - H K)^-1 H M~,   R' = L_o^-1 R L_i^-1 = H (M + K R'),   M~ = M diag(M)^-1.                   (M16)
//! ```
//!
//! # Notation
//!
//! | symbol | in code | meaning, unit |
//! |---|---|---|
//! | `p`, `m`, `n`, `N` | `outputs`, `inputs`, `order`, `points` | numbers of outputs, inputs, states, frequencies |
//! | `omega` | `omega` | angular frequency, rad/s, always |
//! | `H_oi(j omega)` | `values[Pair { output, input }][k]` | response, always `[output, input]` |
//! | `G`, `D` | `Delta::gain`, `Delta::delay_s` | delta gain \[-\], delta delay \[s\] |
//! | `k_o`, `k_i` | `output_gains`, `input_gains` | channel gains \[-\] |
//! | `tau_o`, `tau_i` | `output_delays_s`, `input_delays_s` | channel delays \[s\] |
//! | `tau < 0`, `l`, `a`, `b` | `ChannelLeads`, `lead_s`, `zero_s`, `lag_s` | signed delays, lead time, time constants of a lead filter \[s\] |
//! | `M~`, `K`, `H~` | `normalised_mixing`, `feedback`, `CouplingMatrices::response` | mixing, feedback, the physics model with both |
//! | `LB`, `UB` | `Bounds` | bounds of the channels |
//! | `alpha` | `alpha_gain`, `alpha_delay` | weight of the regularisation |
//! | `J`, `Delta J` | `Cost`, `CostChange` | cost, its change; negative is better |
//! | `d(a, b)`, `s_a`, `r_a` | `BundleDistance`, `Representative::scores`, `Discontinuity::ratios` | distance, score, discontinuity ratio |
//! | `V`, `v` | `airspeed_kt`, `Airspeeds::scaled` | true airspeed \[kt\], scaled airspeed \[-\] |
//!
//! # Modules
//!
//! Each imports only what stands above it; a test reads the sources and asserts that.
//!
//! | module | holds |
//! |---|---|
//! | [`fidelity`] | cost J, distances in a bundle, representative, discontinuity, modes from model to model |
//! | [`correction`] | G, D, bounds, gains, delays, leads, and the corrected model |
//! | [`schedule`] | regression over airspeed, its forms compared, assessment |
//! | [`uncertainty`] | error bars, and the parts of the scatter over the conditions |
//! | [`couplings`] | mixing of inputs and feedback of outputs, fitted to all conditions at once (M16) |
//! | [`requirements`] | bandwidth, time histories, modes, summary costs (M17) |
//!
//! Nothing here knows of files, windows or threads: a caller with several cores hands over an
//! [`Executor`](gdcm_model::executor::Executor).

pub mod correction;
pub mod couplings;
pub mod fidelity;
pub mod requirements;
pub mod schedule;
pub mod uncertainty;
