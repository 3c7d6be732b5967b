//! Writer of uncompressed files for tests, with any contents.

/// Row group of one column chunk per column.
#[derive(Clone)]
pub(super) struct HandmadeGroup {
    /// Pages of each column.
    pub(super) chunks: Vec<Vec<u8>>,
    pub(super) rows: u64,
    /// Offset at which the metadata locate the pages, if they are not stored again.
    pub(super) at: Option<u64>,
}

fn varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value > 0x7f {
        bytes.push(0x80 | u8::try_from(value & 0x7f).unwrap());
        value >>= 7;
    }
    bytes.push(u8::try_from(value).unwrap());
}

/// Writes an integer into a field whose number is `step` above that of the previous field.
fn field(bytes: &mut Vec<u8>, step: u8, value: u64) {
    bytes.push(step << 4 | 5);
    varint(bytes, value << 1);
}

/// Writes the start of a list of structs into a field, as `field` writes an integer.
pub(super) fn list(bytes: &mut Vec<u8>, step: u8, count: usize) {
    bytes.extend([step << 4 | 9, 0xfc]);
    varint(bytes, count as u64);
}

/// Writes a page (kind 0: data, 2: dictionary) that states a length and a number of values.
pub(super) fn page(kind: u64, size: u64, values: u64, encoding: u64, contents: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    field(&mut bytes, 1, kind);
    field(&mut bytes, 1, size);
    field(&mut bytes, 1, contents.len() as u64);
    bytes.push(if kind == 0 { 0x2c } else { 0x4c });
    field(&mut bytes, 1, values);
    field(&mut bytes, 1, encoding);
    bytes.extend([0, 0]);
    bytes.extend(contents);
    bytes
}

/// Writes a file with columns of doubles.
pub(super) fn file(names: &[String], groups: &[HandmadeGroup]) -> Vec<u8> {
    let mut bytes = b"PAR1".to_vec();
    let mut metadata = Vec::new();
    list(&mut metadata, 2, names.len() + 1);
    field(&mut metadata, 5, names.len() as u64);
    metadata.push(0);
    for name in names {
        // Type (5: double), repetition (0: required), name.
        field(&mut metadata, 1, 5);
        field(&mut metadata, 2, 0);
        metadata.push(0x18);
        varint(&mut metadata, name.len() as u64);
        metadata.extend(name.bytes());
        metadata.push(0);
    }
    field(&mut metadata, 1, groups.iter().map(|group| group.rows).sum());
    list(&mut metadata, 1, groups.len());
    for group in groups {
        let mut at = group.at.unwrap_or(bytes.len() as u64);
        list(&mut metadata, 1, group.chunks.len());
        for chunk in &group.chunks {
            // Number of values, length, start.
            metadata.push(0x3c);
            field(&mut metadata, 5, group.rows);
            field(&mut metadata, 2, chunk.len() as u64);
            field(&mut metadata, 2, at);
            metadata.extend([0, 0]);
            at += chunk.len() as u64;
            if group.at.is_none() {
                bytes.extend(chunk);
            }
        }
        field(&mut metadata, 2, group.rows);
        metadata.push(0);
    }
    metadata.push(0);
    with_footer(bytes, &metadata)
}

/// Appends metadata and footer to the pages of a file.
pub(super) fn with_footer(mut pages: Vec<u8>, metadata: &[u8]) -> Vec<u8> {
    pages.extend(metadata);
    pages.extend(u32::try_from(metadata.len()).unwrap().to_le_bytes());
    pages.extend(b"PAR1");
    pages
}
