//! Classes of a project, and the resolution of their names.

use std::{collections::HashMap, rc::Rc, sync::Arc};

use crate::{
    class_id::ClassId,
    source_error::SourceError,
    syntax::{Class, ClassKind, CompilationUnit, Method},
};

/// Classes of a project by their numbers.
#[derive(Debug, Default)]
pub struct Classes {
    known: Vec<KnownClass>,
    units: Vec<FileHeader>,
    /// Classes by `package.Class` or `package.Class.Inner`.
    by_qualified_name: HashMap<String, Vec<ClassId>>,
    /// Methods by name, and constructors by the names of their classes.
    by_method_name: HashMap<String, Vec<Arc<Method>>>,
    /// Main class: copies of classes in its source folder have priority over copies in other source
    /// folders.
    main: Option<ClassId>,
    /// Errors of unusable files, by the expected class name.
    faulty: HashMap<String, SourceError>,
    /// Classes declared in methods, by their memory address: each is added once.
    in_methods: HashMap<usize, ClassId>,
}

/// Class with its place.
#[derive(Debug)]
pub(crate) struct KnownClass {
    pub(crate) class: Arc<Class>,
    pub(crate) file: Rc<str>,
    /// Enclosing class.
    pub(crate) outer: Option<ClassId>,
    unit: usize,
    /// `true` for a local or anonymous class, and for classes within one.
    is_in_method: bool,
}

/// Name and place of a class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassName {
    /// Name without the package.
    pub name: String,
    /// Name with the package.
    pub qualified_name: String,
    /// Source file.
    pub file: String,
    /// Line in the file, from 1.
    pub line: u32,
}

/// Declarations before the classes of a file.
#[derive(Debug)]
struct FileHeader {
    package: String,
    /// Qualified names of imports, by simple name.
    imports: HashMap<String, String>,
    /// Packages and classes of on-demand imports.
    all_of: Vec<String>,
    /// Static imports: the class, and the name of the member; `None` for all members.
    statics: Vec<(String, Option<String>)>,
}

impl Classes {
    /// Adds the classes of a file with its path relative to the project folder.
    pub fn add(&mut self, file: &str, unit: &CompilationUnit) {
        let mut header = FileHeader {
            package: unit.package.clone(),
            imports: HashMap::new(),
            all_of: Vec::new(),
            statics: Vec::new(),
        };
        for import in &unit.imports {
            let last = import.path.rsplit_once('.');
            match (import.is_static, import.is_all, last) {
                (false, true, _) => header.all_of.push(import.path.clone()),
                (true, true, _) => header.statics.push((import.path.clone(), None)),
                (true, false, Some((class, member))) => {
                    header.statics.push((class.to_owned(), Some(member.to_owned())));
                }
                (false, false, Some((_, name))) => {
                    header.imports.insert(name.to_owned(), import.path.clone());
                }
                (_, false, None) => {}
            }
        }
        self.units.push(header);
        let place = (self.units.len() - 1, Rc::from(file));
        for class in &unit.classes {
            self.add_class(class, None, &place, &unit.package);
        }
    }

    /// Adds a file that cannot be used.
    pub fn add_faulty(&mut self, file: &str, error: &SourceError) {
        let name = file.rsplit('/').next().unwrap_or(file).trim_end_matches(".java");
        self.faulty.insert(name.to_owned(), error.clone());
    }

    /// Returns the error of the file of this class, with or without its package.
    #[must_use]
    pub fn faulty(&self, name: &str) -> Option<&SourceError> {
        self.faulty.get(simple(name))
    }

    fn add_class(
        &mut self,
        class: &Arc<Class>,
        outer: Option<ClassId>,
        place: &(usize, Rc<str>),
        above: &str,
    ) -> ClassId {
        let id = ClassId(self.known.len());
        let (unit, file) = place.clone();
        let is_in_method = outer.is_some_and(|outer| self.is_in_method(outer));
        let class_of_file = Arc::clone(class);
        self.known.push(KnownClass { class: class_of_file, file, outer, unit, is_in_method });
        let separator = if above.is_empty() { "" } else { "." };
        let qualified = format!("{above}{separator}{}", class.name);
        for method in class.methods.iter().chain(&class.constructors) {
            let named = self.by_method_name.entry(method.name.clone()).or_default();
            named.push(Arc::clone(method));
        }
        for inner in &class.classes {
            self.add_class(inner, Some(id), place, &qualified);
        }
        self.by_qualified_name.entry(qualified).or_default().push(id);
        id
    }

    /// Adds a local or anonymous class in a method of `outer`.
    pub(crate) fn in_method(&mut self, class: &Arc<Class>, outer: ClassId) -> ClassId {
        let address = Arc::as_ptr(class) as usize;
        if let Some(id) = self.in_methods.get(&address) {
            return *id;
        }
        let place = (self.known(outer).unit, Rc::clone(&self.known(outer).file));
        // The address makes the name unique and unreachable from outside.
        let id = self.add_class(class, Some(outer), &place, &format!("{address}"));
        self.in_methods.insert(address, id);
        for known in &mut self.known[id.0..] {
            known.is_in_method = true;
        }
        id
    }

    /// Returns true for a local or anonymous class, and for classes within one.
    pub(crate) fn is_in_method(&self, id: ClassId) -> bool {
        self.known(id).is_in_method
    }

    /// Returns the class of a number that this instance has assigned.
    pub(crate) fn known(&self, id: ClassId) -> &KnownClass {
        &self.known[id.0]
    }

    /// Resolves `name`, as written within the class `from`; `None` if it is not a class of the
    /// project.
    pub(crate) fn find(&self, name: &str, from: ClassId) -> Option<ClassId> {
        self.search(name, from, true)
    }

    /// Resolves a name as [`find`](Self::find) does. Inner classes of superclasses are included
    /// only if `inherits`, because the superclasses are unknown while they are being resolved.
    fn search(&self, name: &str, from: ClassId, inherits: bool) -> Option<ClassId> {
        if let Some((above, inner_name)) = name.rsplit_once('.') {
            let whole = self.by_qualified_name(name);
            return whole
                .or_else(|| self.inner(self.search(above, from, inherits)?, inner_name, inherits));
        }
        let mut around = Some(from);
        while let Some(id) = around {
            if self.known(id).class.name == name {
                return Some(id);
            }
            if let Some(inner) = self.inner(id, name, inherits) {
                return Some(inner);
            }
            around = self.known(id).outer;
        }
        let header = &self.units[self.known(from).unit];
        if let Some(whole) = header.imports.get(name) {
            return self.by_qualified_name(whole);
        }
        let in_package = |package: &str| {
            let separator = if package.is_empty() { "" } else { "." };
            self.by_qualified_name(&format!("{package}{separator}{name}"))
        };
        in_package(&header.package)
            .or_else(|| header.all_of.iter().find_map(|package| in_package(package)))
    }

    /// Finds the class `name` within `id` or, if `inherits`, within a superclass.
    fn inner(&self, id: ClassId, name: &str, inherits: bool) -> Option<ClassId> {
        let candidates = if inherits { self.with_parents(id) } else { vec![id] };
        candidates.into_iter().find_map(|id| {
            let mut inner = (id.0 + 1..self.known.len()).map(ClassId);
            let is_there = self.known(id).class.classes.iter().any(|class| class.name == name);
            let is_it = |inner: &ClassId| {
                self.known(*inner).outer == Some(id) && self.known(*inner).class.name == name
            };
            is_there.then(|| inner.find(is_it)).flatten()
        })
    }

    /// Returns the methods of this name, and the constructors of classes of this name, of all
    /// classes.
    pub(crate) fn named_methods(&self, name: &str) -> &[Arc<Method>] {
        self.by_method_name.get(name).map_or(&[], Vec::as_slice)
    }

    /// Returns true if several methods, or constructors of a class of this name, exist in the
    /// project; overriding methods count as well.
    pub(crate) fn is_overloaded(&self, name: &str) -> bool {
        self.named_methods(name).len() > 1
    }

    /// Returns the superclass, if it belongs to the project.
    pub(crate) fn parent(&self, id: ClassId) -> Option<ClassId> {
        let name = &self.known(id).class.extends.as_ref()?.name;
        // The class itself and its inner classes cannot be its superclass.
        let outer = match self.known(id).outer {
            Some(outer) => self.search(name, outer, false),
            None => self.find_beside(name, id),
        };
        outer.filter(|parent| *parent != id)
    }

    fn find_beside(&self, name: &str, id: ClassId) -> Option<ClassId> {
        (self.known(id).class.name != *name).then(|| self.search(name, id, false)).flatten()
    }

    /// Returns the class, and the project classes and interfaces from which it inherits, each once,
    /// the nearest first.
    pub(crate) fn with_parents(&self, id: ClassId) -> Vec<ClassId> {
        let mut ancestors = vec![id];
        let mut above = self.parent(id);
        while let Some(parent) = above.filter(|parent| !ancestors.contains(parent)) {
            ancestors.push(parent);
            above = self.parent(parent);
        }
        let mut next = 0;
        while let Some(&class) = ancestors.get(next) {
            for name in &self.known(class).class.implements {
                let interface = match self.known(class).outer {
                    Some(outer) => self.search(&name.name, outer, false),
                    None => self.find_beside(&name.name, class),
                };
                ancestors.extend(interface.filter(|interface| !ancestors.contains(interface)));
            }
            next += 1;
        }
        ancestors
    }

    /// Returns a class of the inheritance cycle, if one exists.
    pub(crate) fn cycle(&self, id: ClassId) -> Option<ClassId> {
        let mut seen = vec![id];
        let mut above = self.parent(id);
        while let Some(parent) = above {
            if seen.contains(&parent) {
                return Some(parent);
            }
            seen.push(parent);
            above = self.parent(parent);
        }
        None
    }

    /// Returns the first superclass outside the project, by its simple name.
    pub(crate) fn foreign_parent(&self, id: ClassId) -> Option<&str> {
        let mut last = id;
        for _ in 0..=self.known.len() {
            match self.parent(last) {
                Some(parent) => last = parent,
                None => break,
            }
        }
        let class = &self.known(last).class;
        let name = class.extends.as_ref().or(class.implements.first())?;
        Some(simple(&name.name))
    }

    pub(crate) fn is_a(&self, id: ClassId, other: ClassId) -> bool {
        self.with_parents(id).contains(&other)
    }

    /// Returns the methods of this name that objects of the class have, the nearest first, with
    /// their classes.
    pub(crate) fn methods(&self, id: ClassId, name: &str) -> Vec<(ClassId, Arc<Method>)> {
        let methods_of = |class: ClassId| {
            let methods = self.known(class).class.methods.iter();
            methods
                .filter(|method| method.name == name)
                .map(move |method| (class, Arc::clone(method)))
        };
        self.with_parents(id).into_iter().flat_map(methods_of).collect()
    }

    /// Returns the classes whose static members of this name are imported in the file of `from`.
    pub(crate) fn static_imports(&self, name: &str, from: ClassId) -> Vec<String> {
        let statics = self.units[self.known(from).unit].statics.iter();
        let has =
            statics.filter(|(_, member)| member.as_ref().is_none_or(|imported| imported == name));
        has.map(|(class, _)| class.clone()).collect()
    }

    /// Returns the class with this qualified name; the preferred one, if the project has several
    /// copies.
    pub(crate) fn by_qualified_name(&self, name: &str) -> Option<ClassId> {
        self.preferred(name).first().copied()
    }

    /// Returns the copies of a class in the main class's source folder; all copies, if that folder
    /// has none.
    fn preferred(&self, name: &str) -> Vec<ClassId> {
        let all = self.by_qualified_name.get(name).map_or(&[][..], Vec::as_slice);
        let beside = |id: &&ClassId| {
            self.main.is_some_and(|main| self.source_folder(main) == self.source_folder(**id))
        };
        let beside: Vec<_> = all.iter().filter(beside).copied().collect();
        if beside.is_empty() { all.to_vec() } else { beside }
    }

    /// Returns the folder that contains the package folders.
    fn source_folder(&self, id: ClassId) -> &str {
        let file = &*self.known(id).file;
        let folder = file.rsplit_once('/').map_or("", |(folder, _)| folder);
        let packages = self.package(id).replace('.', "/");
        folder.strip_suffix(packages.as_str()).unwrap_or(folder).trim_end_matches('/')
    }

    /// Sets the main class.
    pub(crate) fn set_main(&mut self, id: ClassId) {
        self.main = Some(id);
    }

    pub(crate) fn main(&self) -> Option<ClassId> {
        self.main
    }

    /// Returns the files of other copies of a class with different contents, which are equally
    /// preferred.
    pub(crate) fn copies(&self, id: ClassId) -> Vec<&str> {
        let KnownClass { class, outer, .. } = self.known(id);
        if outer.is_some() {
            return Vec::new();
        }
        let package = self.package(id);
        let dot = if package.is_empty() { "" } else { "." };
        let others = self.preferred(&format!("{package}{dot}{}", class.name));
        let contents = |id: ClassId| format!("{:?}", self.known(id).class);
        let others = others.into_iter().filter(|other| *other != id);
        let different = others.filter(|other| contents(*other) != contents(id));
        different.map(|other| &*self.known(other).file).collect()
    }

    /// Returns the concrete top-level classes whose first superclass outside the project is one of
    /// `bases`, sorted by file and line.
    #[must_use]
    pub fn extending(&self, bases: &[&str]) -> Vec<(ClassId, ClassName)> {
        let is_it = |id: &ClassId| {
            let KnownClass { class, outer, .. } = &self.known(*id);
            class.kind == ClassKind::Class
                && !class.is_abstract
                && outer.is_none()
                && self.cycle(*id).is_none()
                && self.foreign_parent(*id).is_some_and(|base| bases.contains(&base))
        };
        let name = |id: ClassId| {
            let KnownClass { class, file, .. } = &self.known(id);
            let package = self.package(id);
            let dot = if package.is_empty() { "" } else { "." };
            let qualified_name = format!("{package}{dot}{}", class.name);
            let (name, file) = (class.name.clone(), file.to_string());
            (id, ClassName { name, qualified_name, file, line: class.line })
        };
        let mut matches: Vec<_> = self.ids().filter(is_it).map(name).collect();
        matches.sort_by(|(_, a), (_, b)| (&a.file, a.line).cmp(&(&b.file, b.line)));
        matches
    }

    /// Returns the numbers of all classes.
    pub(crate) fn ids(&self) -> impl Iterator<Item = ClassId> + use<> {
        (0..self.known.len()).map(ClassId)
    }

    /// Returns the package of the file that declares the class.
    pub(crate) fn package(&self, id: ClassId) -> &str {
        &self.units[self.known(id).unit].package
    }
}

/// Returns a name without its qualifier.
pub(crate) fn simple(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, simple)| simple)
}
