//! Fast tests of the whole program.

mod command;
mod compare;
mod help;
mod mistakes;
mod render;
