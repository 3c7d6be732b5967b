//! Mesh files of payloads that a program names.

use std::{collections::BTreeMap, path::Path};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use iiwa_files::{MAX_MESH_BYTES, NotBeside, beside, read_mesh};
use iiwa_json::{JsonStep, excerpt, locate};
use iiwa_program::{
    FlangeLoad, LoadShape, MAX_ERRORS, Motion, MotionIndex, Program, ProgramError, Sources,
    motion_path,
};

use crate::Error;

/// Contents of mesh files, by their names in the program.
pub(crate) type Meshes = BTreeMap<String, Vec<u8>>;

/// Maximum size of the mesh files of all shapes together, in bytes: the program that is stored in
/// plans contains the file of each shape. To store each file once, the format of programs would
/// need names for embedded files.
const MAX_BYTES: u64 = MAX_MESH_BYTES;

/// Mesh of a payload in a program.
struct LoadMesh<'a> {
    /// Name of the tool that has the payload; `None` for a load change.
    tool: Option<&'a str>,
    /// Index of the load change.
    motion: Option<usize>,
    shape: usize,
    file: &'a str,
}

impl LoadMesh<'_> {
    /// Path of the file name in the text of the program.
    fn path(&self, text: &str) -> Vec<JsonStep<'_>> {
        use JsonStep::{Index, Key};
        let mut path = match (self.tool, self.motion) {
            (Some(name), _) => vec![Key("tools"), Key(name)],
            (None, motion) => motion_path(text, MotionIndex::new(motion.unwrap_or_default())),
        };
        path.extend([Key("load"), Key("shapes"), Index(self.shape), Key("file")]);
        path
    }

    fn error(&self, reason: &str, text: &str, sources: &Sources) -> ProgramError {
        let tool = self.tool.map(|name| format!("tool `{}`: ", excerpt(name))).unwrap_or_default();
        let (shape, file) = (self.shape + 1, excerpt(self.file));
        ProgramError::Json {
            message: format!("{tool}shape {shape} of the load: `{file}`: {reason}"),
            motion: self.motion.map(MotionIndex::new),
            sources: sources.clone(),
            place: locate(text, &self.path(text)),
        }
    }
}

/// Returns all meshes of payloads in a program, those in a repeat block once: all rounds have the
/// same text.
fn named(program: &Program) -> Vec<LoadMesh<'_>> {
    fn add<'a>(
        meshes: &mut Vec<LoadMesh<'a>>,
        tool: Option<&'a str>,
        motion: Option<usize>,
        payload: &'a FlangeLoad,
    ) {
        for (shape, form) in payload.shapes.iter().enumerate() {
            if let LoadShape::Mesh { file, .. } = form {
                meshes.push(LoadMesh { tool, motion, shape, file });
            }
        }
    }
    let mut meshes = Vec::new();
    for (name, tool) in &program.workcell.tools {
        if let Some(payload) = &tool.load {
            add(&mut meshes, Some(name), None, payload);
        }
    }
    for (index, entry) in program.motions.iter().enumerate() {
        if let Motion::Load(Some(payload)) = entry
            && program.sources.rounds(MotionIndex::new(index)).iter().all(|it| it.number == 1)
        {
            add(&mut meshes, None, Some(index), payload);
        }
    }
    meshes
}

/// Reads the meshes that a program, read from `text`, names; `read` returns the contents of a file.
pub(crate) fn meshes(
    program: &Program,
    text: &str,
    read: impl Fn(&str) -> Result<Vec<u8>, String>,
) -> Result<Meshes, Error> {
    let (mut meshes, mut errors) = (Meshes::new(), Vec::new());
    // Sizes of the files read so far; none for data URIs, which the program itself contains.
    let mut sizes: BTreeMap<&str, Option<u64>> = BTreeMap::new();
    let mut total = 0;
    for mesh in named(program) {
        if errors.len() == MAX_ERRORS {
            break;
        }
        let to_error = |reason: &str| Error::Program(mesh.error(reason, text, &program.sources));
        if !sizes.contains_key(mesh.file) {
            let is_embedded = LoadShape::data_uri(mesh.file).is_some();
            let size = match embedded_mesh(mesh.file).unwrap_or_else(|| read(mesh.file)) {
                Ok(_) if is_embedded => None,
                Ok(bytes) => {
                    let size = bytes.len() as u64;
                    meshes.insert(mesh.file.to_owned(), bytes);
                    Some(size)
                }
                Err(reason) => {
                    errors.push(to_error(&reason));
                    None
                }
            };
            sizes.insert(mesh.file, size);
        }
        total += sizes.get(mesh.file).copied().flatten().unwrap_or_default();
        if total > MAX_BYTES {
            errors.push(to_error(&format!(
                "the mesh files of all shapes up to here have {total} bytes; they may have \
                 {MAX_BYTES} in all, and a file counts for each shape that names it: make the \
                 meshes coarser, or name them in fewer shapes"
            )));
            break;
        }
    }
    if errors.is_empty() { Ok(meshes) } else { Err(Error::several(errors)) }
}

/// Reads a mesh file from the folder of the program at `path`; the error is the reason.
pub(crate) fn read_beside(path: &Path, name: &str) -> Result<Vec<u8>, String> {
    if path == Path::new("-") {
        return Err(
            "the program is read from standard input, so that the folder of its meshes is \
                    unknown: write it to a file"
                .to_owned(),
        );
    }
    let file = beside(path, name, &["stl", "obj"]).map_err(|reason| match reason {
        NotBeside::Elsewhere => {
            "it has to be a file *.stl or *.obj beside the program or in a folder below it"
                .to_owned()
        }
        reason => reason.to_string(),
    })?;
    read_mesh(&file)
}

/// Returns `text` with data URIs in place of the names of mesh files; `None` without such names.
/// `text` contains all tools of the program.
pub(crate) fn with_embedded(text: &str, program: &Program, meshes: &Meshes) -> Option<String> {
    let mut uris = Vec::new();
    for mesh in named(program) {
        let Some(bytes) = meshes.get(mesh.file) else { continue };
        let format = LoadShape::mesh_format(mesh.file)?;
        let uri = format!("\"data:model/{format};base64,{}\"", STANDARD.encode(bytes));
        uris.push((locate(text, &mesh.path(text)).span, uri));
    }
    uris.sort_by_key(|(span, _)| span.start);
    let mut embedded = String::new();
    let mut end = 0;
    for (span, uri) in &uris {
        embedded.push_str(&text[end..span.start]);
        embedded.push_str(uri);
        end = span.end;
    }
    embedded.push_str(&text[end..]);
    (!uris.is_empty()).then_some(embedded)
}

/// Returns the contents of a mesh that a program contains as a data URI, such as the program that
/// is stored in a plan; `None` for the name of a file. The error is the reason why it cannot be
/// read.
#[must_use]
pub fn embedded_mesh(file: &str) -> Option<Result<Vec<u8>, String>> {
    let (_, base64) = LoadShape::data_uri(file)?;
    Some(STANDARD.decode(base64).map_err(|error| format!("the data URI is not base64: {error}")))
}
