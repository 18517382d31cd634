// SPDX-License-Identifier: MIT
// The paper's figure 11 as a curve: the recall of each view, from the worst to the best. A curve an
// occluder, a panel a family of quads.
#include "judgement.h"
#include "report.h"

#include <stdlib.h>
#include <string.h>

enum {
    WIDTH = 1000,
    PANEL = 400, // side of a panel
    LEFT = 70,   // of the first panel
    BETWEEN = 80,
    TOP = 94,
    LEGEND_LINE = 22,
    MOST_POINTS = 512, // of a curve
    COLOUR_COUNT = 8,
};

// Okabe and Ito's colours, which colour-blind people can tell apart; then the same again, dashed.
static const char* const COLOURS[COLOUR_COUNT] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                  "#e69f00", "#56b4e9", "#000000", "#8c6d31"};
static const char* const DASHES[] = {"", " stroke-dasharray=\"7 4\"", " stroke-dasharray=\"2 3\""};

static const char* GetDash(size_t index)
{
    return DASHES[index / COLOUR_COUNT % (sizeof DASHES / sizeof *DASHES)];
}

// A text of an SVG file; what is no UTF-8, or no character of XML, becomes U+FFFD.
static void PrintText(pvtOutput* output, const char* text)
{
    while (*text != '\0') {
        const size_t length = pvtGetUtf8Length(text);
        if (length == 0 || (unsigned char)*text < 0x20) {
            pvtOutput_Print(output, "\xEF\xBF\xBD");
            ++text;
            continue;
        }
        if (*text == '<') {
            pvtOutput_Print(output, "&lt;");
        } else if (*text == '>') {
            pvtOutput_Print(output, "&gt;");
        } else if (*text == '&') {
            pvtOutput_Print(output, "&amp;");
        } else {
            pvtOutput_Write(output, text, length);
        }
        text += length;
    }
}

static void PlotAxes(pvtOutput* output, int x, const char* title)
{
    pvtOutput_Print(output, "<text x=\"%d\" y=\"%d\" class=\"head\">%s</text>\n", x, TOP - 12,
                    title);
    for (int k = 0; k <= 5; ++k) {
        const int across = x + k * PANEL / 5, down = TOP + PANEL - k * PANEL / 5;
        pvtOutput_Print(output,
                        "<path class=\"grid\" d=\"M%d %dv%dM%d %dh%d\"/>\n"
                        "<text x=\"%d\" y=\"%d\" class=\"mid\">%d</text>\n"
                        "<text x=\"%d\" y=\"%d\" class=\"end\">%d</text>\n",
                        across, TOP, PANEL, x, down, PANEL, across, TOP + PANEL + 18, 20 * k, x - 8,
                        down + 4, 20 * k);
    }
    pvtOutput_Print(output,
                    "<text x=\"%d\" y=\"%d\" class=\"mid\">views, from the worst to the best "
                    "[%%]</text>\n"
                    "<text transform=\"translate(%d %d) rotate(-90)\" class=\"mid\">recall of the "
                    "view [%%]</text>\n",
                    x + PANEL / 2, TOP + PANEL + 40, x - 42, TOP + PANEL / 2);
}

static int CompareNumbers(const void* a, const void* b)
{
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

// View k of n stands in the middle of its share of the axis, so that one view is a level line.
static void PlotCurve(pvtOutput* output, int x, const double* recalls, size_t count, size_t index)
{
    pvtOutput_Print(output, "<path class=\"curve\" stroke=\"%s\"%s d=\"",
                    COLOURS[index % COLOUR_COUNT], GetDash(index));
    const size_t points = count < MOST_POINTS ? count : MOST_POINTS;
    for (size_t p = 0; p < points; ++p) {
        const size_t rank = points == 1 ? 0 : p * (count - 1) / (points - 1);
        const double across = x + PANEL * ((double)rank + 0.5) / (double)count;
        const double down = TOP + PANEL * (1.0 - recalls[rank]);
        if (p == 0) {
            pvtOutput_Print(output, "M%d %.2fH%.2f", x, down, across);
        }
        pvtOutput_Print(output, "L%.2f %.2f", across, down);
        if (p + 1 == points) {
            pvtOutput_Print(output, "H%d", x + PANEL);
        }
    }
    pvtOutput_Print(output, "\"/>\n");
}

static void PlotPanel(pvtOutput* output, const pvtJudgement* judgement, bool isSmall)
{
    const pvtEvaluation* evaluation = judgement->evaluation;
    double* recalls = judgement->recalls;
    const int x = LEFT + (isSmall ? PANEL + BETWEEN : 0);
    PlotAxes(output, x, isSmall ? "Small quads" : "Uniform quads");
    // The first lies on top.
    for (size_t i = evaluation->count; i-- > 0;) {
        const pvtOccluderScore* score = &evaluation->occluders[i];
        for (size_t v = 0; v < score->viewCount; ++v) {
            const pvtViewScore* view = &score->views[v];
            recalls[v] = isSmall ? view->small.recall : view->uniform.recall;
        }
        qsort(recalls, score->viewCount, sizeof *recalls, CompareNumbers);
        PlotCurve(output, x, recalls, score->viewCount, i);
    }
}

static void PlotLegend(pvtOutput* output, const pvtJudgement* judgement)
{
    int y = TOP + PANEL + 76;
    for (size_t i = 0; i < judgement->evaluation->count; ++i, y += LEGEND_LINE) {
        const pvtOccluderScore* score = &judgement->evaluation->occluders[i];
        char triangles[32], name[256];
        pvtOutput_Print(output,
                        "<path class=\"curve\" stroke=\"%s\"%s d=\"M%d %dh34\"/>\n"
                        "<text x=\"%d\" y=\"%d\">",
                        COLOURS[i % COLOUR_COUNT], GetDash(i), LEFT, y - 4, LEFT + 44, y);
        pvtShortenName(judgement->names[i], 48, name, sizeof name);
        PrintText(output, name);
        pvtOutput_Print(
            output,
            "</text>\n<text x=\"%d\" y=\"%d\" class=\"end\">%s triangles, recall of all "
            "views %.1f %% (uniform), %.1f %% (small)</text>\n",
            LEFT + 2 * PANEL + BETWEEN, y, pvtFormatCount(score->triangleCount, triangles),
            100.0 * score->uniform.recall, 100.0 * score->small.recall);
    }
}

void pvtPlotRecall(pvtOutput* output, const pvtJudgement* judgement)
{
    const pvtEvaluation* evaluation = judgement->evaluation;
    const int height = TOP + PANEL + 90 + LEGEND_LINE * (int)evaluation->count;
    char quads[32], name[256];
    pvtOutput_Print(output,
                    "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
                    "viewBox=\"0 0 %d %d\">\n"
                    "<style>text{font:13px sans-serif;fill:#222}.head{font-weight:bold}"
                    ".title{font:bold 18px sans-serif}.mid{text-anchor:middle}"
                    ".end{text-anchor:end}.grid{stroke:#d8d8d8;fill:none}"
                    ".curve{fill:none;stroke-width:2}</style>\n"
                    "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n"
                    "<text x=\"%d\" y=\"32\" class=\"title\">",
                    WIDTH, height, WIDTH, height, LEFT);
    pvtOutput_Print(output, "Recall over %d %s of ", evaluation->options.views,
                    evaluation->options.views == 1 ? "view" : "views");
    pvtShortenName(judgement->originalName, 60, name, sizeof name);
    PrintText(output, name);
    pvtOutput_Print(output,
                    "</text>\n<text x=\"%d\" y=\"52\">%s random quads of each kind a view"
                    "</text>\n",
                    LEFT, pvtFormatCount((uint64_t)evaluation->options.quads, quads));
    PlotPanel(output, judgement, false);
    PlotPanel(output, judgement, true);
    PlotLegend(output, judgement);
    pvtOutput_Print(output, "</svg>\n");
}
