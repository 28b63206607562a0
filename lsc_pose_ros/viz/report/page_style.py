# Copyright 2026 lsc_pose_ros contributors
# SPDX-License-Identifier: Apache-2.0
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The style sheet of all pages: one column on a phone, a light and a dark scheme."""

from lsc_pose_ros.viz.drawing.colours import PALETTE

# A shadow at the right of a table says that it goes on there.
_RULES = """
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--page);
  max-width: 68rem; margin: 2rem auto; padding: 0 1rem; overflow-wrap: break-word }
h1 { font-size: 1.6rem; line-height: 1.25; overflow-wrap: anywhere }
h2 { font-size: 1.2rem; margin-top: 2.5rem }
p, li, figcaption { max-width: 44rem }
a { color: var(--link) }
figure { margin: 1rem 0 }
figcaption, .muted, dt, footer, summary { color: var(--faint) }
figcaption { font-size: .9rem }
footer { margin-top: 3rem; border-top: 1px solid var(--border); padding-top: .5rem }
.charts { display: flex; flex-wrap: wrap; gap: 1rem 2rem; align-items: flex-start }
.chart { flex: 1 1 20rem; max-width: 30rem; min-width: 0; height: auto; display: block }
.frames { display: grid; grid-template-columns: repeat(auto-fill, minmax(9.5rem, 1fr));
  gap: 1rem; align-items: start }
.frames.large { grid-template-columns: repeat(auto-fill, minmax(min(15rem, 100%), 1fr)) }
.frames figure { margin: 0 }
.frames img { width: 100%; height: auto; display: block; border-radius: 4px }
.legend { list-style: none; display: flex; flex-wrap: wrap; gap: .2rem 1.2rem; margin: .5rem 0;
  padding: 0; font-size: .9rem }
.legend li { display: flex; align-items: center; gap: .4rem; overflow-wrap: anywhere }
.swatch { flex: none; border-radius: 3px }
.chart, .swatch { stroke-linejoin: round; stroke-linecap: butt }
.headline { display: flex; gap: 1rem 3rem; flex-wrap: wrap }
.headline b { display: block; font-size: 2rem; line-height: 1.2 }
.headline span { color: var(--faint) }
.scroll { overflow-x: auto; width: fit-content; max-width: 100%; margin: 1rem 0; background:
  linear-gradient(to left, var(--page) 60%, transparent) right / 2rem 100% no-repeat local,
  linear-gradient(to left, var(--border), transparent) right / .8rem 100% no-repeat scroll }
.scroll td { white-space: nowrap }
.scroll td:first-child { white-space: normal; overflow-wrap: anywhere; min-width: 6rem }
.scroll:focus-visible { outline: 2px solid var(--link) }
table { border-collapse: collapse; font-variant-numeric: tabular-nums }
th, td { padding: .15rem 1.2rem .15rem 0; text-align: right; vertical-align: top;
  border-bottom: 1px solid var(--border) }
th:first-child, td:first-child, .words td, .words th { text-align: left }
tfoot td { font-weight: bold }
dl { display: grid; grid-template-columns: max-content auto; gap: .2rem 1.5rem }
dd { margin: 0; overflow-wrap: anywhere; max-width: 44rem }
summary { cursor: pointer }
code { overflow-wrap: anywhere }
.warning { border-left: 4px solid var(--ink); padding: .5rem 1rem; font-weight: bold }
"""

# Tables of words have one cell below the other on a phone.
_PHONE = """@media (max-width: 40rem) {
body { margin-top: 1rem }
h1 { font-size: 1.4rem }
th, td { padding-right: .8rem }
.words, .words tbody, .words tr, .words td { display: block }
.words thead { display: none }
.words td { border: 0; padding: 0 }
.words tr { border-bottom: 1px solid var(--border); padding: .4rem 0 }
dl { display: block } dd { margin-bottom: .4rem }
}
"""

# Pictures on white paper are less glaring on a dark page.
_DARK = '.frames img, .paper .swatch { filter: brightness(.88) }'


def style_sheet() -> str:
    """Return the style sheet, in which each colour of the palette is a variable."""
    return f'{colour_sheet()}{_RULES}{_PHONE}@media (prefers-color-scheme: dark) {{ {_DARK} }}\n'


def colour_sheet() -> str:
    """Return only the colours, as variables of CSS by their names in the palette.

    Elements of the class `on_black` have the colours of a dark page in both schemes.
    """
    light = ' '.join(f'--{name}: {shades.light};' for name, shades in PALETTE.items())
    dark = ' '.join(f'--{name}: {shades.dark};' for name, shades in PALETTE.items())
    return (
        f'\n:root {{ color-scheme: light dark; {light} }}\n.on_black {{ {dark} }}\n'
        f'@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n'
    )
