//! The Gain-Delay Correction Method: results as figures, figures as SVG, PDF and PNG.
//!
//! **Question answered:** how is a result drawn, on paper and (painted by the window) on the
//! screen?
//!
//! | module | contents |
//! |---|---|
//! | [`figure`] | a figure of every view: plots, panels, axes, marks, and their layout on paper |
//! | [`paper`] | a laid-out figure as SVG, PDF or PNG |
//!
//! Nothing here depends on egui or the file system. For an example see [`figure`].

pub mod figure;
pub mod paper;
