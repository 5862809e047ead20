//! Mistakes on the way into the file.

use super::super::measure::Finish;
use super::{Group, Mistake, Of};
use crate::lighting::Early;

const OUTPUT: Mistake = Mistake {
    name: "",
    group: Group::Output,
    title: "",
    what: "",
    remedy: "",
    of: Of::Any,
    amount: None,
    make: |_| false,
};

/// The table of this group.
pub(super) fn mistakes() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "srgb-applied",
            title: "sRGB encoding (or a gamma of about 2.2)",
            what: "Dark tones are too light: values are sRGB-encoded on their way into the file. OpenGL's window, and this \
                   comparison, store linear values as they are.",
            remedy: "Store the values as they are; or, if you mean the encoding, check with --srgb.",
            make: |c| {
                c.only(Finish::Encode, None);
                true
            },
            ..OUTPUT
        },
        Mistake {
            name: "srgb-missing",
            title: "No sRGB encoding, or decoded once too often",
            what: "Dark tones are too dark. With --srgb the file should hold sRGB values and holds linear ones; without it, \
                   linear values went through the sRGB curve the wrong way (a texture's decoding, say).",
            remedy: "Encode exactly once, and only if the file is to hold sRGB values.",
            make: |c| {
                c.only(Finish::Decode, None);
                true
            },
            ..OUTPUT
        },
        Mistake {
            name: "eight-bits-early",
            title: "8 bits before the sum",
            what: "Terms are rounded to 8 bits before they are added: each brings an error of up to half a step, and \
                   smooth ramps show bands.",
            remedy: "Keep colours as real numbers until the file is written.",
            make: |c| {
                c.lighting(|f| f.early = Early::EightBits);
                true
            },
            ..OUTPUT
        },
        Mistake {
            name: "eight-bits-cut-off",
            title: "8 bits by cutting off",
            what: "Values are (int)(255 c): on average half a step too dark.",
            remedy: "Round: (int)(255 c + 0.5).",
            make: |c| {
                c.only(Finish::CutOff, None);
                true
            },
            ..OUTPUT
        },
    ]
}
