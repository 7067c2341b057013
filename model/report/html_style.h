// SPDX-License-Identifier: Apache-2.0
// The look of the HTML report: light and dark as the reader has it, and down to a phone's width.
#pragma once

namespace fasttree::model {

// The colours of stages stay apart for the colour-blind (Okabe and Ito).
inline constexpr const char* kHtmlStyle = R"css(
:root {
  color-scheme: light dark;
  --page: #ffffff; --card: #f4f5f7; --text: #1c1e21; --soft: #5f6670; --line: #d8dce2;
  --busy: #0072b2; --stalled: #e69f00; --bad: #b3261e;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #15171a; --card: #1f2328; --text: #e6e8eb; --soft: #9aa3ad; --line: #353b43;
    --busy: #4aa8e0; --stalled: #e0a020; --bad: #ff8a80;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 1rem; max-width: 64rem; background: var(--page); color: var(--text);
  font: 16px/1.45 system-ui, sans-serif;
}
h1 { font-size: 1.5rem; margin: 0.5rem 0 0; }
h2 { font-size: 1.15rem; margin: 2rem 0 0.5rem; }
p { margin: 0.4rem 0; }
.soft { color: var(--soft); }
.bad { color: var(--bad); font-weight: 600; }
code { overflow-wrap: anywhere; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(9.5rem, 1fr)); gap: 0.6rem; margin: 1rem 0; }
.tiles div { background: var(--card); border-radius: 0.5rem; padding: 0.6rem 0.8rem; }
.tiles b { display: block; font-size: 1.3rem; font-variant-numeric: tabular-nums; }
.tiles span { color: var(--soft); font-size: 0.85rem; }
svg { display: block; width: 100%; background: var(--card); }
svg.bar { height: 2.4rem; }
svg.strip { height: 1.5rem; }
svg.area { height: 12rem; }
.plot { position: relative; min-width: 0; }
.axis { position: relative; height: 1.5rem; font-size: 0.75rem; color: var(--soft); }
.axis span { position: absolute; top: 0.15rem; transform: translateX(-50%); white-space: nowrap; }
.axis span:first-child { transform: none; }
.axis span.end { transform: translateX(-100%); }
.chart { display: grid; grid-template-columns: 2.4rem 1fr; }
.scale { position: relative; height: 12rem; font-size: 0.75rem; color: var(--soft); }
.scale span { position: absolute; right: 0.4rem; transform: translateY(-50%); }
.rows { display: grid; grid-template-columns: minmax(5rem, max-content) 1fr 4rem; gap: 0.2rem 0.6rem; align-items: center; font-size: 0.85rem; }
.rows > span { overflow-wrap: anywhere; }
.rows > span:nth-child(3n) { text-align: right; font-variant-numeric: tabular-nums; color: var(--soft); }
.keys { font-size: 0.85rem; color: var(--soft); }
.key { margin-right: 1rem; white-space: nowrap; display: inline-block; }
.key i, td i { display: inline-block; width: 0.8rem; height: 0.8rem; margin-right: 0.4rem; vertical-align: -0.05rem; border-radius: 0.15rem; }
.key i.memorypeak, .key i.buspeak { height: 0; border-radius: 0; vertical-align: 0.25rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums; min-width: 100%; }
th, td { text-align: right; padding: 0.25rem 0.6rem; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
th { color: var(--soft); font-weight: 600; }
td.words { text-align: left; white-space: normal; min-width: 12rem; }
th.words, td.name { text-align: left; }
tr.sum td { font-weight: 600; border-bottom: 0; }
details { margin: 0.8rem 0; }
summary { cursor: pointer; }
pre { overflow-x: auto; background: var(--card); padding: 0.8rem; border-radius: 0.5rem; font-size: 0.8rem; }
path.busy, rect.busy { fill: var(--busy); } i.busy { background: var(--busy); }
path.stalled { fill: var(--stalled); } i.stalled { background: var(--stalled); }
path.bandwidth { fill: var(--busy); } i.bandwidth { background: var(--busy); }
path.border, path.grid, path.memorypeak, path.buspeak { fill: none; vector-effect: non-scaling-stroke; }
path.border { stroke: var(--text); stroke-opacity: 0.35; }
path.grid { stroke: var(--line); }
path.memorypeak { stroke: #d55e00; stroke-width: 2; } i.memorypeak { border-top: 2px solid #d55e00; }
path.buspeak { stroke: #009e73; stroke-width: 2; stroke-dasharray: 6 4; } i.buspeak { border-top: 2px dashed #009e73; }
.s0 { fill: #0072b2; background: #0072b2; } .s1 { fill: #56b4e9; background: #56b4e9; }
.s2 { fill: #e69f00; background: #e69f00; } .s3 { fill: #d55e00; background: #d55e00; }
.s4 { fill: #009e73; background: #009e73; } .s5 { fill: #cc79a7; background: #cc79a7; }
.s6 { fill: #999999; background: #999999; } .s7 { fill: #b5a800; background: #b5a800; }
)css";

}  // namespace fasttree::model
