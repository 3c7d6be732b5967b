//! Colours of materials.

use std::{
    collections::{HashMap, hash_map::Entry},
    rc::Rc,
};

use roxmltree::NodeId;

use super::document::{ColladaDocument, XmlElement, child, children, elements, finite_numbers};

/// Red, green and blue, from 0 to 1; `None` if the file states no plain colour, such as for a
/// texture.
type MaterialColour = Option<[f64; 3]>;

/// Reader of colours. Each instance of a geometry, material and effect is read once.
#[derive(Default)]
pub(super) struct MaterialReader<'a> {
    instances: HashMap<NodeId, Rc<HashMap<&'a str, MaterialColour>>>,
    /// Colours of materials and effects.
    colours: HashMap<NodeId, MaterialColour>,
}

impl<'a> MaterialReader<'a> {
    /// Returns the colours that an instance of a geometry gives to material symbols.
    pub(super) fn colours(
        &mut self,
        document: &ColladaDocument<'a>,
        instance: XmlElement<'a>,
    ) -> Rc<HashMap<&'a str, MaterialColour>> {
        if let Some(known) = self.instances.get(&instance.id()) {
            return Rc::clone(known);
        }
        let mut colours = HashMap::new();
        let bound = child(instance, "bind_material");
        let bound = bound.and_then(|bound| child(bound, "technique_common"));
        for bound in bound.into_iter().flat_map(|bound| children(bound, "instance_material")) {
            let Some(symbol) = bound.attribute("symbol") else { continue };
            if let Entry::Vacant(vacant) = colours.entry(symbol) {
                let material = document.find(bound, "target", "material");
                vacant.insert(material.and_then(|material| self.material(document, material)));
            }
        }
        let colours = Rc::new(colours);
        self.instances.insert(instance.id(), Rc::clone(&colours));
        colours
    }

    fn material(
        &mut self,
        document: &ColladaDocument<'a>,
        material: XmlElement<'a>,
    ) -> MaterialColour {
        if let Some(known) = self.colours.get(&material.id()) {
            return *known;
        }
        let effect = child(material, "instance_effect");
        let effect = effect.and_then(|instance| document.find(instance, "url", "effect"));
        let colour = effect
            .and_then(|effect| *self.colours.entry(effect.id()).or_insert_with(|| colour(effect)));
        self.colours.insert(material.id(), colour);
        colour
    }
}

fn colour(effect: XmlElement<'_>) -> MaterialColour {
    let technique = child(child(effect, "profile_COMMON")?, "technique")?;
    let colour = elements(technique).find_map(|shader| {
        let lit = match shader.tag_name().name() {
            "blinn" | "lambert" | "phong" => "diffuse",
            "constant" => "emission",
            _ => return None,
        };
        child(child(shader, lit)?, "color")
    })?;
    match finite_numbers(colour)?.as_slice() {
        [red, green, blue] | [red, green, blue, _] => {
            Some([*red, *green, *blue].map(|share| share.clamp(0.0, 1.0)))
        }
        _ => None,
    }
}
