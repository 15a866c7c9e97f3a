/** Creates an element with attributes (functions become listeners) and children. */
function make(tag, attributes = {}, ...children) {
  return fit(document.createElement(tag), attributes, children);
}

function fit(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}
