//! Every test that is not beside the code it tests, as one program: linking the window library is what building tests spends
//! its time on.

mod analysis;
mod commands;
mod dataset_file;
mod messages;
mod optimiser;
mod outputs;
mod structure;
mod window;
