#pragma once

#include <string_view>

namespace kino::bench {

/// Colours of series are told apart by people who see red and green alike (after Okabe and Ito), a
/// little darker on white and lighter on black.
constexpr std::string_view kPageStyle = R"css(
:root { color-scheme: light dark; --page: #fdfdfc; --ink: #1b1d21; --quiet: #5c626d; --line: #d9dce1;
  --card: #ffffff; --link: #0b5cad; --miss: #a8430a;
  --s0: #0068a8; --s1: #b85000; --s2: #00785a; --s3: #a64d79; --s4: #2f86c1; --s5: #8a6d00;
  --s6: #555b66; --s7: #b02a3c; }
@media (prefers-color-scheme: dark) { :root { --page: #15171b; --ink: #e9eaec; --quiet: #a0a6b0;
  --line: #363a42; --card: #1c1f24; --link: #7db9f0; --miss: #f0a070;
  --s0: #6bb6ec; --s1: #f09a52; --s2: #4fcfa8; --s3: #e09ac0; --s4: #9fd0f5; --s5: #e0c65a;
  --s6: #b4bac5; --s7: #f08590; } }
body { margin: 0 auto; padding: 24px 20px 60px; max-width: 1400px; background: var(--page);
  color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 26px; margin: 0 0 8px; } h2 { font-size: 20px; margin: 44px 0 4px;
  padding-top: 14px; border-top: 1px solid var(--line); }
p { max-width: 76ch; margin: 6px 0; } a { color: var(--link); }
.q { color: var(--quiet); font-size: 13px; } .m { color: var(--miss); }
code { font: 13px ui-monospace, monospace; overflow-wrap: anywhere; }
nav { display: flex; flex-wrap: wrap; gap: 4px 16px; margin: 14px 0; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 400px), 1fr));
  gap: 16px; margin-top: 14px; }
figure { margin: 0; padding: 12px 12px 8px; background: var(--card);
  border: 1px solid var(--line); border-radius: 8px; }
figcaption { font-size: 13px; margin-bottom: 4px; } figcaption b { font-size: 14px; }
svg { display: block; width: 100%; height: auto; color: var(--ink); }
svg text { font: 10.5px system-ui, sans-serif; fill: var(--quiet); }
svg .t { fill: var(--ink); } svg .b { font-weight: 700; }
svg .g { stroke: var(--line); fill: none; } svg .a { stroke: var(--quiet); fill: none; }
svg .d { fill: none; stroke: var(--ink); stroke-width: 1.6; }
svg .l { fill: none; stroke-width: 1.2; opacity: .55; }
svg [class^="s"], .k [class^="s"] { fill: var(--card); stroke-width: 1.6; }
svg .l[class*=" s"] { fill: none; }
.s0 { stroke: var(--s0); } .s1 { stroke: var(--s1); } .s2 { stroke: var(--s2); }
.s3 { stroke: var(--s3); } .s4 { stroke: var(--s4); } .s5 { stroke: var(--s5); }
.s6 { stroke: var(--s6); } .s7 { stroke: var(--s7); }
svg .s0.f { fill: var(--s0); } svg .s1.f { fill: var(--s1); } svg .s2.f { fill: var(--s2); }
svg .s3.f { fill: var(--s3); } svg .s4.f { fill: var(--s4); } svg .s5.f { fill: var(--s5); }
svg .s6.f { fill: var(--s6); } svg .s7.f { fill: var(--s7); }
.k { margin: 4px 0 0; padding: 0; list-style: none; display: flex; flex-wrap: wrap;
  gap: 2px 12px; font-size: 12px; color: var(--quiet); }
.k li { display: flex; align-items: center; gap: 4px; } .k svg { width: 14px; flex: none; }
details { margin-top: 8px; } summary { cursor: pointer; font-size: 13px; color: var(--link); }
.x { border: 1px solid var(--miss); border-radius: 8px; padding: 6px 14px 10px; margin: 12px 0; }
.x ul { margin: 6px 0 0; padding-left: 20px; font-size: 13px; } ul.m { margin: 0; font-size: 14px; }
svg.i { display: inline-block; width: 18px; height: 18px; vertical-align: -4px; }
svg.i [class^="s"] { fill: var(--card); stroke-width: 1.6; } svg.i .s0.f { fill: var(--s0); }
.w { overflow: auto; max-height: 70vh; margin-top: 6px; border: 1px solid var(--line);
  border-radius: 8px; background: var(--card); }
table { border-collapse: collapse; font-size: 12.5px; width: 100%; }
th, td { text-align: left; padding: 3px 10px; border-bottom: 1px solid var(--line);
  font-variant-numeric: tabular-nums; vertical-align: top; }
thead th { position: sticky; top: 0; background: var(--card); } tr.b td { font-weight: 700; }
th[colspan] { padding-top: 12px; }
:target { scroll-margin-top: 8px; } figure:target { border-color: var(--link); }
a:focus-visible, summary:focus-visible, .w:focus-visible { outline: 2px solid var(--link); }
@media print { figure { break-inside: avoid; } }
)css";

}  // namespace kino::bench
