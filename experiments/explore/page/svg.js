// Elements of SVG and HTML, made in one call each. Text is only ever set as text.

const SVG_NAMES = "http://www.w3.org/2000/svg";

/** An SVG element with attributes and children; a string among the children is text. */
export function svg(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG_NAMES, name);
  setAll(made, attributes);
  made.append(...children);
  return made;
}

/** An HTML element; the attribute `on` holds its listeners by the name of the event. */
export function html(name, attributes = {}, ...children) {
  const { on = {}, ...plain } = attributes;
  const made = document.createElement(name);
  setAll(made, plain);
  for (const [event, listener] of Object.entries(on)) made.addEventListener(event, listener);
  made.append(...children);
  return made;
}

/** Attributes of an element; null or false takes one away. */
export function setAll(element, attributes) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === null || value === false) element.removeAttribute(key);
    else element.setAttribute(key, value === true ? "" : String(value));
  }
}

/** A name that may be written from right to left, kept apart from the text around it. */
export function foreign(text) {
  return html("bdi", {}, text);
}

/** A symbol with a subscript, for example sigma with "first" below. */
export function subscripted(symbol, below) {
  return html("span", { class: "symbol" }, html("i", {}, symbol), html("sub", {}, below));
}
