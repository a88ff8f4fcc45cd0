// Elements made by hand: whatever the server sent becomes text, never markup.

/** The element of the page with this id. */
export const byId = (id) => document.getElementById(id);

/** A new element with a class and children; strings become text nodes. */
export function element(tag, className = "", ...children) {
  const node = document.createElement(tag);
  if (className) node.className = className;
  node.append(...children.map((child) => child ?? ""));
  return node;
}

/**
 * Fills `host` with buttons of which one is pressed; `options` are [value, label, title].
 * Returns `{ value, choose, next }`; `onChange(value)` is called for clicks and for calls alike.
 */
export function choice(host, options, onChange) {
  let value = options[0][0];
  const buttons = options.map(([option, label, title]) => {
    const button = element("button", "", label);
    button.type = "button";
    button.title = title ?? "";
    button.addEventListener("click", (event) => {
      // A mouse leaves the keyboard to the page.
      if (event.detail > 0) button.blur();
      choose(option);
    });
    return button;
  });
  const mark = () =>
    buttons.forEach((button, k) => button.setAttribute("aria-pressed", options[k][0] === value));
  function choose(option) {
    if (option === value) return;
    value = option;
    mark();
    onChange(value);
  }
  host.replaceChildren(...buttons);
  mark();
  return {
    get value() {
      return value;
    },
    choose,
    next: () => {
      const k = options.findIndex(([option]) => option === value);
      choose(options[(k + 1) % options.length][0]);
    },
  };
}

/** Rows of a definition list: name, value. */
export function definitions(rows) {
  return rows.flatMap(([name, value]) => [element("dt", "", name), element("dd", "", value)]);
}
