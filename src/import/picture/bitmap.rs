//! Windows bitmaps whose channels have more than 8 bits (10-10-10, as cameras and screens have them), which the package
//! `image` would cut to 8, and those that are not read.

use super::{Assumed, Decoded, Trouble, checked_size, plane};

/// The header's `biCompression` for bit masks, without and with alpha.
const BITFIELDS: [u32; 2] = [3, 6];

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at + 4)?;
    Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
}

/// The picture, where a channel is wider than 8 bits; none where another reader does.
pub(super) fn deep(bytes: &[u8]) -> Result<Option<Decoded>, Trouble> {
    let (Some(header), Some(layout), Some(compression)) =
        (word(bytes, 14), word(bytes, 26), word(bytes, 30))
    else {
        return Ok(None);
    };
    if header < 40 {
        return Ok(None);
    }
    let kind = match compression {
        4 => "a JPEG inside a BMP",
        5 => "a PNG inside a BMP",
        11..=13 => "a BMP of printing colours (CMYK)",
        _ => "",
    };
    if !kind.is_empty() {
        let message = format!("this is {kind}, which is not read");
        return Err(Trouble::Unsupported(
            message,
            "save the picture as PNG".into(),
        ));
    }
    if !BITFIELDS.contains(&compression) || layout >> 16 != 32 {
        return Ok(None);
    }
    let has_alpha = header >= 56 || compression == 6;
    let mask = |i: usize| word(bytes, 54 + 4 * i).unwrap_or(0);
    let masks = [
        mask(0),
        mask(1),
        mask(2),
        if has_alpha { mask(3) } else { 0 },
    ];
    let bits = masks[..3].iter().map(|m| m.count_ones()).max().unwrap_or(0);
    if bits <= 8 {
        return Ok(None);
    }
    masked(bytes, masks, bits).map(Some)
}

/// The pixels behind their masks.
fn masked(bytes: &[u8], masks: [u32; 4], bits: u32) -> Result<Decoded, Trouble> {
    let field = |at: usize| word(bytes, at).unwrap_or(0);
    let (width, height) = (field(18) as i32, field(22) as i32);
    let size = checked_size(width.max(0) as u64, height.unsigned_abs().into())?;
    let channels = if masks[3] == 0 { 3 } else { 4 };
    let start = field(10) as usize;
    let data = bytes
        .get(start..)
        .and_then(|data| data.get(..4 * size.0 * size.1));
    let data = data.ok_or_else(|| Trouble::broken("it ends before its last pixel"))?;
    let value = |pixel: u32, mask: u32| match mask {
        0 => 0.0,
        mask => {
            let shift = mask.trailing_zeros();
            (f64::from((pixel & mask) >> shift) / f64::from(mask >> shift)) as f32
        }
    };
    let rows = data.chunks_exact(4 * size.0);
    // Rows go up unless the height is negative.
    let rows: Vec<&[u8]> = if height > 0 {
        rows.rev().collect()
    } else {
        rows.collect()
    };
    let pixels = rows.into_iter().flat_map(|row| row.chunks_exact(4));
    let words = pixels.map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let values: Vec<f32> = words
        .flat_map(|pixel| {
            masks[..channels]
                .iter()
                .map(move |mask| value(pixel, *mask))
        })
        .collect();
    let mut notes = Vec::new();
    let pixels = plane(size, channels, &values, &mut notes);
    Ok(Decoded {
        bits: Some(bits as u8),
        pixels,
        orientation: 1,
        assumed: Assumed::unmarked(),
        notes,
    })
}
