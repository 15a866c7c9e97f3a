// Elements of HTML and SVG.

/** An element with attributes (functions listen) and children. */
function make(tag, attributes = {}, ...children) {
  return fit(document.createElement(tag), attributes, children);
}

/** The same in a picture. */
function draw(tag, attributes = {}, ...children) {
  return fit(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function fit(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}
