//! Fast tests of the repository and of the program as a whole.

mod tidy;
