//! Image metrics and difference maps on borrowed pixel views.
#![forbid(unsafe_code)]
