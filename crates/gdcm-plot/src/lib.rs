//! The Gain-Delay Correction Method: results as figures, figures as SVG, PDF and PNG.
//!
//! **Question answered:** how is a result drawn, on paper and (painted by the window) on the screen?
//!
//! | module | holds |
//! |---|---|
//! | [`figure`] | a figure of every view: plots, panels, axes, marks, and their layout on paper |
//! | [`paper`] | a laid-out figure as SVG, PDF or PNG |
//!
//! Nothing here knows egui or the file system. An example stands in [`figure`].

pub mod figure;
pub mod paper;
