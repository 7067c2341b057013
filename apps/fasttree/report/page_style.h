// SPDX-License-Identifier: Apache-2.0
// What the page of an evaluation has beyond the look of a simulation's report
// (model/report/html_style.h): contents, figures, rows of bars, and paper.
#pragma once

namespace fasttree::report {

inline constexpr const char* kPageStyle = R"css(
html { -webkit-text-size-adjust: 100%; scroll-padding-top: 0.5rem; }
body { padding: 1rem 1rem 4rem; overflow-wrap: break-word; }
h1 { font-size: 1.7rem; line-height: 1.2; margin-bottom: 0.4rem; }
h2 { font-size: 1.35rem; margin: 3rem 0 0.6rem; padding-top: 0.8rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.8rem 0 0.4rem; }
main p, header p { max-width: 46rem; }
a { color: var(--busy); }
nav ol { columns: 2 14rem; padding-left: 1.4rem; margin: 1rem 0; }
nav li { padding: 0.15rem 0; }
figure { margin: 1rem 0; min-width: 0; }
figcaption { color: var(--soft); font-size: 0.85rem; margin-top: 0.4rem; max-width: 46rem; }
img { display: block; max-width: 100%; height: auto; border-radius: 0.4rem; background: var(--card); }
.gallery { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(18rem, 100%), 1fr)); gap: 0 1.2rem; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(22rem, 100%), 1fr)); gap: 0 1.6rem; align-items: end; }
.pair > * { min-width: 0; }
.scroll { margin: 0.8rem 0; }
caption { text-align: left; color: var(--soft); padding-bottom: 0.3rem; }
th, td { padding: 0.25rem 0.45rem; }
thead th { border-bottom: 2px solid var(--line); vertical-align: bottom; }
tbody th { color: var(--text); font-weight: 500; }
th.words, td.words { text-align: left; white-space: normal; min-width: 9rem; }
tr[data-measured] > :first-child::after, .bar[data-measured] > :first-child::after { content: " \25F7"; color: var(--soft); }
.bars { display: grid; gap: 0.25rem; font-size: 0.85rem; }
.bar { display: grid; grid-template-columns: 12rem 1fr 10rem; gap: 0 0.7rem; align-items: center; break-inside: avoid; }
.bar > span:last-child { color: var(--soft); font-variant-numeric: tabular-nums; }
.tornado .bar { grid-template-columns: 17rem 1fr 16rem; }
.group { font-weight: 600; margin: 0.7rem 0 0; break-after: avoid; }
svg.strip { height: 1.1rem; border-radius: 0.15rem; }
.tornado svg.strip { height: 1.5rem; }
rect.less { fill: #009e73; } rect.more { fill: #d55e00; }
path.middle { stroke: var(--soft); fill: none; vector-effect: non-scaling-stroke; }
@media (max-width: 44rem) {
  .bar { grid-template-columns: 1fr 9.5rem; margin-bottom: 0.35rem; }
  .tornado .bar { grid-template-columns: 1fr; margin-bottom: 0.6rem; }
  .bar > span:first-child { grid-column: 1 / -1; }
}
@media print {
  :root { --page: #ffffff; --card: #f4f5f7; --text: #000000; --soft: #444444; --line: #bbbbbb; --busy: #0072b2; color-scheme: light; }
  * { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  @page { margin: 14mm; }
  body { font-size: 10pt; max-width: none; padding: 0; }
  a { color: inherit; text-decoration: none; }
  #table1, #table3, #machines, #bandwidth, #assumptions, #method { break-before: page; }
  h2, h3, caption { break-after: avoid; }
  h2 { border-top: 0; margin-top: 0; }
  figure, tr, img, .tiles div { break-inside: avoid; }
  thead { display: table-header-group; }
  .scroll { overflow: visible; }
  details::details-content { content-visibility: visible; block-size: auto; }
  summary { list-style: none; }
  table { font-size: 7.5pt; min-width: 0; width: 100%; }
  th, td { white-space: normal; padding: 0.15rem 0.3rem; }
  th.words, td.words { min-width: 0; }
}
)css";

}  // namespace fasttree::report
