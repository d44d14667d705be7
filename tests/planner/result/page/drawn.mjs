// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs a page's script on a document of few lines, and returns what it draws as HTML. No browser, no packages.
import { createHash } from 'node:crypto';

const escaped = (text) => text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;').replace(/"/g, '&quot;');

class Node {}
class Text extends Node {
  constructor(text) { super(); this.text = text; }
  toString() { return escaped(this.text); }
}
class Element extends Node {
  constructor(tag) { super(); Object.assign(this, { tag, attributes: {}, children: [], style: {}, dataset: {}, scrollTop: 0 }); }
  setAttribute(name, value) { this.attributes[name] = value; }
  append(...more) { this.children.push(...more.map((one) => one instanceof Node ? one : new Text(String(one)))); }
  replaceChildren(...more) { this.children = []; this.append(...more); }
  addEventListener() {}
  contains() { return false; }
  get inside() { return this.children.join(''); }
  toString() {
    const all = Object.entries({ ...this.attributes, ...(this.style.cssText ? { style: this.style.cssText } : {}) });
    return `<${this.tag}${all.map(([name, value]) => ` ${name}="${escaped(value)}"`).join('')}>${this.inside}</${this.tag}>`;
  }
}
class SVGElement extends Element {}
class HTMLElement extends Element {}
/// Keeps a document's text as the one element of it.
class DOMParser {
  parseFromString(text) {
    const element = new SVGElement('svg');
    element.toString = () => text;
    return { documentElement: element };
  }
}

/// The parts of a page as the program writes it. Throws unless its policy allows its script alone.
export function parts_of(page) {
  const [, policy] = page.match(/http-equiv="Content-Security-Policy" content="([^"]*)"/);
  const scripts = [...page.matchAll(/<script([^>]*)>([\s\S]*?)<\/script>/g)];
  if (scripts.length !== 2 || scripts[0][1] !== ' type="application/json" id="data"' || scripts[1][1] !== '')
    throw new Error(`the page has ${scripts.length} scripts`);
  const [[, , data], [, , script]] = scripts;
  const hash = createHash('sha256').update(script).digest('base64');
  if (!policy.endsWith(`script-src 'sha256-${hash}'`)) throw new Error(`the policy is ${policy}`);
  return { data: JSON.parse(data), script, shell: page.replace(data, '').replace(script, '') };
}

/// What a script draws of data, as HTML.
export function drawn(script, data) {
  const main = new HTMLElement('main');
  const document = {
    createElement: (tag) => new HTMLElement(tag),
    createElementNS: (_, tag) => new SVGElement(tag),
    querySelector: () => main,
    getElementById: () => ({ textContent: JSON.stringify(data) }),
    documentElement: new HTMLElement('html'),
    activeElement: null
  };
  const given = { document, Node, Element, HTMLElement, SVGElement, DOMParser, HTMLInputElement: class {}, addEventListener() {},
                  matchMedia: () => ({ matches: false, addEventListener() {} }) };
  new Function(...Object.keys(given), script)(...Object.values(given));
  return main.inside;
}
