#include "hil/html_page.hpp"

namespace steadyboom::hil {

namespace {

constexpr std::string_view common_style = R"(
:root{color-scheme:light dark;--paper:#fcfcfa;--ink:#1d2329;--soft:#5c6670;--line:#d9dcdf;--panel:#fff;--tint:#e8f1f8;
--good:#006b4f;--fair:#8a5800;--bad:#a32a1e}
@media (prefers-color-scheme:dark){:root{--paper:#14181c;--ink:#e4e7ea;--soft:#9aa4ad;--line:#343b42;--panel:#1a1f24;
--tint:#18303f;--good:#3fc79b;--fair:#e0a84a;--bad:#f0897d}}
*{box-sizing:border-box}
body{margin:0 auto;padding:2.2rem 1.1rem 3rem;max-width:76rem;background:var(--paper);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
h1{font-size:1.9rem;line-height:1.2;margin:0}
h2{font-size:1.3rem;margin:2.5rem 0 .3rem}
h3{font-size:1.08rem;margin:1.7rem 0 .3rem}
p{margin:.5rem 0;max-width:48rem}
.soft,figcaption span,small{color:var(--soft)}
.key{display:flex;flex-wrap:wrap;gap:.2rem 1.3rem;margin:.3rem 0 .8rem}
.sticky{position:sticky;top:0;z-index:1;background:var(--paper);border-bottom:1px solid var(--line);padding:.45rem 0}
.swatch{display:inline-block;width:1.6em;height:0;border-top:.25em solid;vertical-align:.22em;margin-right:.45em}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,29rem),1fr));gap:1.3rem 1.6rem}
figure{margin:0;break-inside:avoid}
figcaption{font-size:.95rem;margin:.2rem 0}
figcaption span{margin-left:.4em}
svg{display:block;width:100%;height:auto;font-family:inherit}
table{border-collapse:collapse}
th,td{border-bottom:1px solid var(--line)}
thead th{border-bottom:2px solid var(--ink);vertical-align:bottom}
@media (max-width:34rem){body{padding-top:1.2rem}h1{font-size:1.5rem}.key{font-size:.85rem}}
@media print{:root{color-scheme:light;--paper:#fff;--ink:#000;--soft:#444;--line:#bbb;--panel:#fff;--tint:#eef4f8;
--good:#006b4f;--fair:#8a5800;--bad:#a32a1e}
body{font-size:10pt;padding:0;max-width:none}.sticky{position:static}
.plots{grid-template-columns:1fr 1fr;gap:.6rem}h2,h3,.key{break-after:avoid}tr{break-inside:avoid}}
)";

}  // namespace

std::string html_text(std::string_view text) {
    std::string result;
    for (const char character : text) {
        switch (character) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += character;
        }
    }
    return result;
}

HtmlPage::HtmlPage(std::string_view title, std::string_view own_style) {
    put("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>Steadyboom: {}</title>\n<style>{}{}</style>\n</head>\n<body>\n",
        html_text(title), common_style, own_style);
}

void HtmlPage::put_key(std::span<const KeyEntry> entries, bool sticky) {
    put("<div class=\"key{}\">", sticky ? " sticky" : "");
    for (const KeyEntry& entry : entries) {
        put("<span><i class=\"swatch\" style=\"border-color:{}{}\"></i>{}</span>", entry.colour,
            entry.dashed ? ";border-top-style:dashed" : "", entry.words);
    }
    put("</div>\n");
}

void HtmlPage::put_plot(Plot plot, std::string_view symbol, std::string_view words, int buckets) {
    for (Curve& curve : plot.curves) {
        curve = thinned(curve, plot.x_range, buckets);
    }
    put("<figure>\n<figcaption><b>{}</b><span>{}</span></figcaption>\n", symbol, words);
    places_.push_back(text_.size());
    put("</figure>\n");
    plots_.push_back(std::move(plot));
}

std::string HtmlPage::finished() && {
    put("</body>\n</html>\n");
    const std::vector<std::string> elements = draw_plots(plots_);
    std::string whole;
    std::size_t from = 0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
        whole.append(text_, from, places_[i] - from).append(elements[i]);
        from = places_[i];
    }
    return whole.append(text_, from);
}

}  // namespace steadyboom::hil
