// SPDX-License-Identifier: AGPL-3.0-or-later
// What is checked of every screen: axe-core's rules, and that nothing reaches out of the window.
import fs from 'node:fs';
import { createRequire } from 'node:module';

const axe = fs.readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/// Violations as lines: the rule, what it says, and the first elements.
export async function violations(one, screen) {
  // The page's policy allows no script but its own and those of the debugger.
  if (!(await one.page.evaluate(() => 'axe' in window))) await one.page.evaluate(axe);
  const { violations: found } = await one.page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
  return found.map((one_of) => `${screen}: ${one_of.id}: ${one_of.help}: ${one_of.nodes.slice(0, 4).map((node) => `${node.target.join(' ')} ${node.any[0]?.message ?? ''}`).join('; ')}`);
}

/// What reaches out of the window and cannot be scrolled into it.
export const beside = (screen) => [...document.querySelectorAll('button, select, input, h1, h2, p, table')].flatMap((each) => {
  const box = each.getBoundingClientRect();
  if (!box.width || !each.checkVisibility({ visibilityProperty: true }) || (box.left >= -1 && box.right <= innerWidth + 1)) return [];
  for (let around = each.parentElement; around && around !== document.body; around = around.parentElement)
    if (['auto', 'scroll'].includes(getComputedStyle(around).overflowX) && around.scrollWidth > around.clientWidth) return [];
  return each.matches('.unseen, .unseen *') ? [] : [`${screen}: ${each.tagName} ${each.className} "${each.textContent.trim().slice(0, 30)}" from ${box.left} to ${box.right}`];
});
