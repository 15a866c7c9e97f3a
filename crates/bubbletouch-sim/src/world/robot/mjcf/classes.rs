//! `<default>` classes: attributes of elements that an element of the model does not contain.

use super::compiler::Compiler;
use super::limits::CLASS_DEPTH;
use crate::error::Result;
use crate::text::xml::Element;
use glam::DVec3;

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
            let name = element.attribute("class");
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
        CLASS_DEPTH.check(depth, element)?;
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
        let Some(name) = element.attribute(attribute) else {
            return Ok(None);
        };
        let found = self.classes.iter().position(|class| class.name == name);
        // The root can also be referred to by its default name.
        let found = found.or_else(|| (name == MAIN).then_some(0));
        found.map(Some).ok_or_else(|| {
            let names = self.classes.iter().map(|class| class.name);
            element.unknown(attribute, "default class", names)
        })
    }

    /// Returns an element and its defaults, from the innermost class outwards. The innermost class is the attribute `class` of the element, otherwise the class
    /// with the index `class`.
    ///
    /// # Errors
    /// If the element names a class that does not exist.
    pub fn layers(&self, element: Element<'a>, class: usize) -> Result<Vec<Element<'a>>> {
        let own = self.class_of(element, "class")?;
        let mut layers = vec![element];
        let mut class = Some(own.unwrap_or(class));
        while let Some(index) = class {
            for defaults in self.classes[index].elements.iter().rev() {
                let n_before = layers.len();
                layers.extend(defaults.children(element.tag()));
                layers[n_before..].reverse();
            }
            class = self.classes[index].parent;
        }
        Ok(layers)
    }
}

/// Element with its defaults.
pub(super) struct Item<'a> {
    /// The element, then elements of default classes from the innermost class outwards.
    layers: Vec<Element<'a>>,
    /// Settings of the element's model.
    pub compiler: &'a Compiler,
}

impl<'a> Item<'a> {
    /// Creates an element with its layers, of which the first is the element itself.
    pub fn new(layers: Vec<Element<'a>>, compiler: &'a Compiler) -> Self {
        Self { layers, compiler }
    }

    /// Returns the element itself, without defaults.
    pub fn own(&self) -> Element<'a> {
        self.layers[0]
    }

    /// Returns the innermost layer that has one of these attributes; the element itself if no layer has any.
    pub fn layer(&self, attributes: &[&str]) -> Element<'a> {
        let has = |layer: &&Element| attributes.iter().any(|it| layer.attribute(it).is_some());
        self.layers.iter().find(has).copied().unwrap_or(self.own())
    }

    /// Returns the value of an attribute, or `None` if neither the element nor a default class has it.
    pub fn text(&self, attribute: &str) -> Option<&'a str> {
        self.layer(&[attribute]).attribute(attribute)
    }

    /// Returns the N finite numbers in the value of an attribute, or `None` if neither the element nor a default class has it.
    ///
    /// # Errors
    /// If the value does not consist of N finite numbers.
    pub fn numbers<const N: usize>(&self, attribute: &str) -> Result<Option<[f64; N]>> {
        self.layer(&[attribute]).numbers(attribute)
    }

    /// Returns the vector in the value of an attribute, or `default`.
    ///
    /// # Errors
    /// If the value is not three finite numbers.
    pub fn vector(&self, attribute: &str, default: DVec3) -> Result<DVec3> {
        self.layer(&[attribute]).vector(attribute, default)
    }

    /// Returns the number in the value of an attribute, or `default`.
    ///
    /// # Errors
    /// If the value is not one finite number.
    pub fn number(&self, attribute: &str, default: f64) -> Result<f64> {
        let number = self.layer(&[attribute]).number(attribute)?;
        Ok(number.unwrap_or(default))
    }

    /// Returns the value that belongs to the word of an attribute, or `default`.
    ///
    /// # Errors
    /// If the word is another one.
    pub fn one_of<T: Copy>(&self, attribute: &str, words: &[(&str, T)], default: T) -> Result<T> {
        let value = self.layer(&[attribute]).one_of(attribute, words)?;
        Ok(value.unwrap_or(default))
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
