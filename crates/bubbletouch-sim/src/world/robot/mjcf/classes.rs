//! `<default>` classes: attributes of elements that an element of the model does not contain.

use crate::error::Result;
use crate::text::spelling::nearest_names;
use crate::world::robot::xml::Element;

/// Default classes of a model. The first class is the root; each other class inherits the attributes of its parent that it does not define.
pub(super) struct Classes<'a> {
    classes: Vec<Class<'a>>,
}

struct Class<'a> {
    name: &'a str,
    /// Index of the parent class; `None` for the root.
    parent: Option<usize>,
    /// Elements `<default>` of the class, in the order of the file.
    elements: Vec<Element<'a>>,
}

/// Largest depth of classes inside each other. With a larger value, the stack can overflow.
const MAX_DEPTH: usize = 100;
/// Name of the root class.
const MAIN: &str = "main";

impl<'a> Classes<'a> {
    /// Reads all default classes of a model.
    ///
    /// # Errors
    /// If a nested class has no name.
    pub fn read(root: Element<'a>) -> Result<Self> {
        let main = Class {
            name: MAIN,
            parent: None,
            elements: Vec::new(),
        };
        let mut classes = Self {
            classes: vec![main],
        };
        for element in root.children("default") {
            let name = element.node.attribute("class");
            let class = match name {
                None | Some(MAIN) => 0,
                // The first class at the top is the root, whatever its name.
                Some(name) if classes.classes[0].elements.is_empty() => {
                    classes.classes[0].name = name;
                    0
                }
                Some(name) => classes.named(name, 0),
            };
            classes.add(element, class, 0)?;
        }
        Ok(classes)
    }

    fn add(&mut self, element: Element<'a>, class: usize, depth: usize) -> Result<()> {
        if depth > MAX_DEPTH {
            let given = format!("classes inside each other, {MAX_DEPTH} deep");
            return Err(element.refuse(given, "fewer classes around each other"));
        }
        self.classes[class].elements.push(element);
        for inner in element.children("default") {
            let name = inner.text("class")?;
            let inner_class = self.named(name, class);
            self.add(inner, inner_class, depth + 1)?;
        }
        Ok(())
    }

    /// Returns the index of the class with this name; a new class has the given parent.
    fn named(&mut self, name: &'a str, parent: usize) -> usize {
        let known = self.classes.iter().position(|class| class.name == name);
        known.unwrap_or_else(|| {
            self.classes.push(Class {
                name,
                parent: Some(parent),
                elements: Vec::new(),
            });
            self.classes.len() - 1
        })
    }

    /// Returns the index of the class that an attribute of an element names, such as `childclass`; `None` if the attribute is missing.
    ///
    /// # Errors
    /// If there is no such class.
    pub fn class_of(&self, element: Element, attribute: &str) -> Result<Option<usize>> {
        let Some(name) = element.node.attribute(attribute) else {
            return Ok(None);
        };
        let found = self.classes.iter().position(|class| class.name == name);
        match found {
            Some(class) => Ok(Some(class)),
            // The root can also be referred to by its default name.
            None if name == MAIN => Ok(Some(0)),
            None => {
                let names = self.classes.iter().map(|class| class.name);
                let given = format!("`{attribute}` \"{name}\", which is no default class");
                Err(element.refuse(given, nearest_names(name, names)))
            }
        }
    }

    /// Returns an element with the defaults of its class: its attribute `class`, otherwise the class of the body.
    ///
    /// # Errors
    /// If the element names a class that does not exist.
    pub fn item(&self, element: Element<'a>, class_of_body: usize) -> Result<Item<'a>> {
        let own = self.class_of(element, "class")?;
        let mut layers = vec![element];
        let mut class = Some(own.unwrap_or(class_of_body));
        let tag = element.node.tag_name().name();
        while let Some(index) = class {
            let elements = self.classes[index].elements.iter().rev();
            layers.extend(elements.flat_map(|defaults| {
                let mut same: Vec<Element> = defaults.children(tag).collect();
                same.reverse();
                same
            }));
            class = self.classes[index].parent;
        }
        Ok(Item { layers })
    }
}

/// Element with its defaults.
pub(super) struct Item<'a> {
    /// The element, then elements of default classes from the innermost class outwards.
    layers: Vec<Element<'a>>,
}

impl<'a> Item<'a> {
    /// Returns the element itself, without defaults.
    pub fn own(&self) -> Element<'a> {
        self.layers[0]
    }

    /// Returns the innermost layer that has one of these attributes.
    pub fn layer_with(&self, attributes: &[&str]) -> Option<Element<'a>> {
        let has = |layer: &&Element| {
            attributes
                .iter()
                .any(|name| layer.node.has_attribute(*name))
        };
        self.layers.iter().find(has).copied()
    }

    /// Returns the value of an attribute, or `None` if neither the element nor a default class has it.
    pub fn text(&self, attribute: &str) -> Option<&'a str> {
        self.layer_with(&[attribute])?.node.attribute(attribute)
    }

    /// Returns the N finite numbers in the value of an attribute, or `None` if neither the element nor a default class has it.
    ///
    /// # Errors
    /// If the value does not consist of N finite numbers.
    pub fn numbers<const N: usize>(&self, attribute: &str) -> Result<Option<[f64; N]>> {
        match self.layer_with(&[attribute]) {
            Some(layer) => layer.numbers(attribute),
            None => Ok(None),
        }
    }

    /// Returns the vector in the value of an attribute, or `default`.
    ///
    /// # Errors
    /// If the value is not three finite numbers.
    pub fn vector(&self, attribute: &str, default: glam::DVec3) -> Result<glam::DVec3> {
        Ok(self.numbers(attribute)?.map_or(default, glam::DVec3::from))
    }

    /// Returns the number in the value of an attribute, or `default`.
    ///
    /// # Errors
    /// If the value is not one finite number.
    pub fn number(&self, attribute: &str, default: f64) -> Result<f64> {
        Ok(self.numbers(attribute)?.map_or(default, |[number]| number))
    }

    /// Returns up to N numbers of an attribute. A shorter list replaces the first numbers of the defaults, as in MuJoCo; numbers given nowhere are `default`.
    ///
    /// # Errors
    /// If a value contains something other than 1 to N finite numbers.
    pub fn first_numbers<const N: usize>(
        &self,
        attribute: &str,
        default: [f64; N],
    ) -> Result<[f64; N]> {
        let mut all = default;
        for layer in self.layers.iter().rev() {
            let given = layer.up_to(N, attribute)?;
            all[..given.len()].copy_from_slice(&given);
        }
        Ok(all)
    }
}
