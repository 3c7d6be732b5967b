//! Types of the companion specifications: Devices (OPC 10000-100), Industrial Automation (OPC
//! 10000-200) and Robotics (OPC 40010-1), as published by the OPC Foundation.

use std::io::Read;

use opcua::{
    nodes::{ImportedItem, NodeSet2Import, NodeSetImport},
    types::NodeSetNamespaceMapper,
};
use ruzstd::decoding::StreamingDecoder;

use crate::OpcUaError;

/// Namespace of Devices.
pub(crate) const DEVICES: &str = "http://opcfoundation.org/UA/DI/";
/// Namespace of Robotics.
pub(crate) const ROBOTICS: &str = "http://opcfoundation.org/UA/Robotics/";

/// The files, in dependency order. Compressed, they have a twentieth of their size.
const FILES: [(&str, &[u8]); 3] = [
    ("Opc.Ua.Di.NodeSet2.xml", include_bytes!("../nodesets/Opc.Ua.Di.NodeSet2.xml.zst")),
    ("Opc.Ua.IA.NodeSet2.xml", include_bytes!("../nodesets/Opc.Ua.IA.NodeSet2.xml.zst")),
    (
        "Opc.Ua.Robotics.NodeSet2.xml",
        include_bytes!("../nodesets/Opc.Ua.Robotics.NodeSet2.xml.zst"),
    ),
];

/// A file, ready for import.
pub(crate) struct NodeSet(NodeSet2Import);

/// Returns all files, in dependency order.
pub(crate) fn all() -> Result<Vec<NodeSet>, OpcUaError> {
    FILES.iter().map(|(name, packed)| read(name, packed)).collect()
}

fn read(name: &'static str, packed: &[u8]) -> Result<NodeSet, OpcUaError> {
    let bad =
        |message: String| OpcUaError::Server { message: format!("{name} is damaged: {message}") };
    let mut text = String::new();
    StreamingDecoder::new(packed)
        .map_err(|error| bad(error.to_string()))?
        .read_to_string(&mut text)
        .map_err(|error| bad(error.to_string()))?;
    let import = NodeSet2Import::new_str("en", &without_breaks(&text), Vec::new());
    import.map(NodeSet).map_err(|error| bad(error.to_string()))
}

/// Returns the text without white space in its byte strings: files contain it there, and the
/// importer omits such values.
fn without_breaks(text: &str) -> String {
    let mut shortened = String::with_capacity(text.len());
    let mut is_byte_string = false;
    for piece in text.split_inclusive('>') {
        let (content, tag) = piece.split_at(piece.find('<').unwrap_or(piece.len()));
        if is_byte_string {
            shortened.extend(content.split_ascii_whitespace());
        } else {
            shortened.push_str(content);
        }
        shortened.push_str(tag);
        is_byte_string = tag.contains("ByteString");
    }
    shortened
}

impl NodeSetImport for NodeSet {
    // The importer's own method prints to standard output, which is reserved for the program.
    fn register_namespaces(&self, namespaces: &mut NodeSetNamespaceMapper<'_>) {
        for (index, uri) in (1..).zip(self.get_own_namespaces()) {
            namespaces.add_namespace(&uri, index);
        }
    }

    fn get_own_namespaces(&self) -> Vec<String> {
        self.0.get_own_namespaces()
    }

    fn load<'a>(
        &'a self,
        namespaces: &'a NodeSetNamespaceMapper<'_>,
    ) -> Box<dyn Iterator<Item = ImportedItem> + 'a> {
        self.0.load(namespaces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn byte_strings_lose_their_line_breaks() {
        let text = "<a> b\n<x:ByteString y='z'>ab\r\n  cd\n</x:ByteString><c>d e</c>";
        let expected = "<a> b\n<x:ByteString y='z'>abcd</x:ByteString><c>d e</c>";
        assert_eq!(without_breaks(text), expected);
    }

    #[test]
    fn all_files_can_be_read() {
        let uris: Vec<_> = all().unwrap().iter().map(NodeSet::get_own_namespaces).collect();
        assert_eq!(uris[0], [DEVICES]);
        assert_eq!(uris[2].last().map(String::as_str), Some(ROBOTICS));
    }
}
