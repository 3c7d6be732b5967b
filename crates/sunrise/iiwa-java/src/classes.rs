//! The classes of a project, and what their names mean where they stand.

use std::{collections::HashMap, rc::Rc, sync::Arc};

use crate::{
    class_id::ClassId,
    source_error::SourceError,
    syntax::{Class, ClassKind, Method, Unit},
};

/// Classes of a project by their numbers.
#[derive(Debug, Default)]
pub struct Classes {
    known: Vec<KnownClass>,
    units: Vec<Header>,
    /// By `package.Class` or `package.Class.Inner`.
    by_qualified_name: HashMap<String, Vec<ClassId>>,
    /// Methods, and constructors by the names of their classes.
    by_method_name: HashMap<String, Vec<Arc<Method>>>,
    /// The class that is run: copies of classes beside it are preferred to copies in other source folders.
    main: Option<ClassId>,
    /// Files that cannot be used, by the name of the class that they should have.
    faulty: HashMap<String, SourceError>,
    /// Classes that stand in methods, by where they are in memory: each is added once.
    in_methods: HashMap<usize, ClassId>,
}

/// A class, and where it stands.
#[derive(Debug)]
pub(crate) struct KnownClass {
    pub(crate) class: Arc<Class>,
    pub(crate) file: Rc<str>,
    /// The class within which it stands.
    pub(crate) outer: Option<ClassId>,
    unit: usize,
    /// True for a local or anonymous class, and for classes within one.
    is_in_method: bool,
}

/// What a class is called, and where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassName {
    /// Without its package.
    pub name: String,
    /// With its package.
    pub qualified_name: String,
    /// The file in which it stands.
    pub file: String,
    /// The line in it, from 1.
    pub line: u32,
}

/// What a file says before its classes.
#[derive(Debug)]
struct Header {
    package: String,
    /// What is imported by its simple name: the whole name.
    imports: HashMap<String, String>,
    /// Packages and classes of which all is imported.
    all_of: Vec<String>,
    /// Static imports: the class, and the name of the member; none for all.
    statics: Vec<(String, Option<String>)>,
}

impl Classes {
    /// Adds the classes of a file, which is named from the project's folder on.
    pub fn add(&mut self, file: &str, unit: &Unit) {
        let mut header = Header {
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

    /// What is wrong with the file of this class, with or without its package.
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

    /// A local or anonymous class in a method of `outer`.
    pub(crate) fn in_method(&mut self, class: &Arc<Class>, outer: ClassId) -> ClassId {
        let address = Arc::as_ptr(class) as usize;
        if let Some(id) = self.in_methods.get(&address) {
            return *id;
        }
        let place = (self.known(outer).unit, Rc::clone(&self.known(outer).file));
        // Nobody can name it from outside.
        let id = self.add_class(class, Some(outer), &place, &format!("{address}"));
        self.in_methods.insert(address, id);
        for known in &mut self.known[id.0..] {
            known.is_in_method = true;
        }
        id
    }

    /// True for a local or anonymous class, and for classes within one.
    pub(crate) fn is_in_method(&self, id: ClassId) -> bool {
        self.known(id).is_in_method
    }

    /// The class of a number that this gave.
    pub(crate) fn known(&self, id: ClassId) -> &KnownClass {
        &self.known[id.0]
    }

    /// What `name`, as written within the class `from`, stands for; none if that is not of the project.
    pub(crate) fn find(&self, name: &str, from: ClassId) -> Option<ClassId> {
        self.search(name, from, true)
    }

    /// The same; classes that stand in those from which a class inherits count only if `inherits`: it is not known yet while
    /// these are looked for.
    fn search(&self, name: &str, from: ClassId, inherits: bool) -> Option<ClassId> {
        if let Some((above, own)) = name.rsplit_once('.') {
            let whole = self.by_qualified_name(name);
            return whole
                .or_else(|| self.inner(self.search(above, from, inherits)?, own, inherits));
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

    /// The class `name` that stands in `id` or, if that counts, in one from which it inherits.
    fn inner(&self, id: ClassId, name: &str, inherits: bool) -> Option<ClassId> {
        let own = if inherits { self.with_parents(id) } else { vec![id] };
        own.into_iter().find_map(|id| {
            let mut inner = (id.0 + 1..self.known.len()).map(ClassId);
            let is_there = self.known(id).class.classes.iter().any(|class| class.name == name);
            let is_it = |inner: &ClassId| {
                self.known(*inner).outer == Some(id) && self.known(*inner).class.name == name
            };
            is_there.then(|| inner.find(is_it)).flatten()
        })
    }

    /// The methods of this name, and the constructors of classes of this name, of all classes.
    pub(crate) fn named_methods(&self, name: &str) -> &[Arc<Method>] {
        self.by_method_name.get(name).map_or(&[], Vec::as_slice)
    }

    /// True if a class has several methods of this name, or several constructors, if it is that of a class; those that inherit
    /// from it count as well.
    pub(crate) fn is_overloaded(&self, name: &str) -> bool {
        self.named_methods(name).len() > 1
    }

    /// The class above, if it is of the project.
    pub(crate) fn parent(&self, id: ClassId) -> Option<ClassId> {
        let name = &self.known(id).class.extends.as_ref()?.name;
        // Its own inner classes do not count, nor does it itself.
        let found = match self.known(id).outer {
            Some(outer) => self.search(name, outer, false),
            None => self.find_beside(name, id),
        };
        found.filter(|parent| *parent != id)
    }

    fn find_beside(&self, name: &str, id: ClassId) -> Option<ClassId> {
        (self.known(id).class.name != *name).then(|| self.search(name, id, false)).flatten()
    }

    /// It, and the classes and interfaces of the project from which it inherits, each once, the nearest first.
    pub(crate) fn with_parents(&self, id: ClassId) -> Vec<ClassId> {
        let mut found = vec![id];
        let mut above = self.parent(id);
        while let Some(parent) = above.filter(|parent| !found.contains(parent)) {
            found.push(parent);
            above = self.parent(parent);
        }
        let mut next = 0;
        while let Some(&class) = found.get(next) {
            for name in &self.known(class).class.implements {
                let interface = match self.known(class).outer {
                    Some(outer) => self.search(&name.name, outer, false),
                    None => self.find_beside(&name.name, class),
                };
                found.extend(interface.filter(|interface| !found.contains(interface)));
            }
            next += 1;
        }
        found
    }

    /// The classes from which it inherits in a circle, if it does.
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

    /// The first class above that is not of the project, by its simple name.
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

    /// The methods of this name that objects of the class have, the nearest first, with the class that each stands in.
    pub(crate) fn methods(&self, id: ClassId, name: &str) -> Vec<(ClassId, Arc<Method>)> {
        let of = |class: ClassId| {
            let methods = self.known(class).class.methods.iter();
            methods.filter(|method| method.name == name).map(move |own| (class, Arc::clone(own)))
        };
        self.with_parents(id).into_iter().flat_map(of).collect()
    }

    /// Classes whose members can be used by this name alone, as they are imported in the file of `from`.
    pub(crate) fn static_imports(&self, name: &str, from: ClassId) -> Vec<String> {
        let statics = self.units[self.known(from).unit].statics.iter();
        let has = statics.filter(|(_, member)| member.as_ref().is_none_or(|own| own == name));
        has.map(|(class, _)| class.clone()).collect()
    }

    /// The class of this whole name; the first one, if the project has several copies of it.
    pub(crate) fn by_qualified_name(&self, name: &str) -> Option<ClassId> {
        self.preferred(name).first().copied()
    }

    /// The copies of a class in the source folder of the class that is run; all copies, if that folder has none.
    fn preferred(&self, name: &str) -> Vec<ClassId> {
        let all = self.by_qualified_name.get(name).map_or(&[][..], Vec::as_slice);
        let beside = |id: &&ClassId| {
            self.main.is_some_and(|main| self.source_folder(main) == self.source_folder(**id))
        };
        let beside: Vec<_> = all.iter().filter(beside).copied().collect();
        if beside.is_empty() { all.to_vec() } else { beside }
    }

    /// The folder in which the folders of packages begin.
    fn source_folder(&self, id: ClassId) -> &str {
        let file = &*self.known(id).file;
        let folder = file.rsplit_once('/').map_or("", |(folder, _)| folder);
        let packages = self.package(id).replace('.', "/");
        folder.strip_suffix(packages.as_str()).unwrap_or(folder).trim_end_matches('/')
    }

    /// The class that is run.
    pub(crate) fn set_main(&mut self, id: ClassId) {
        self.main = Some(id);
    }

    pub(crate) fn main(&self) -> Option<ClassId> {
        self.main
    }

    /// The files of other copies of a class, with other contents, that could have been meant as well.
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

    /// The classes of which objects can be made, that stand in no other class, and whose first class above that is not of the
    /// project is one of `bases`; in order of their files and lines.
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
        let mut found: Vec<_> = self.ids().filter(is_it).map(name).collect();
        found.sort_by(|(_, a), (_, b)| (&a.file, a.line).cmp(&(&b.file, b.line)));
        found
    }

    /// All classes that are not in methods.
    pub(crate) fn ids(&self) -> impl Iterator<Item = ClassId> + use<> {
        (0..self.known.len()).map(ClassId)
    }

    /// The package of the file in which it stands.
    pub(crate) fn package(&self, id: ClassId) -> &str {
        &self.units[self.known(id).unit].package
    }
}

/// A name without what it is in.
pub(crate) fn simple(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, simple)| simple)
}
