//! Presses of a patch from Python. The modules are goals of a press ([`goal`]), single presses and batches ([`batch_press`]), slides ([`slide`]), the type
//! of the frames ([`output`]), and [`contacts`].

pub mod batch_press;
pub mod contacts;
pub mod goal;
pub mod output;
pub mod slide;
