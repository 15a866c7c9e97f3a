//! Presses of a patch from Python: what is sought ([`goal`]), single presses and batches ([`batch_press`]), slides ([`slide`]), and what they return.

pub mod batch_press;
pub mod contacts;
pub mod goal;
pub mod jacobian;
pub mod output;
pub mod slide;
