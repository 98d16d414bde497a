//! Pictures and films of Koiter results, without a GPU or a display.
#![forbid(unsafe_code)]
