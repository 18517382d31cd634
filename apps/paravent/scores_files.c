// SPDX-License-Identifier: MIT
// The evaluation as JSON and as CSV.
#include "judgement.h"
#include "values.h"

#include <string.h>

static void WriteQuads(pvtJson* json, const char* key, const pvtQuadScore* score)
{
    pvtJson_BeginObject(json, key);
    pvtJson_Number(json, "precision", score->precision);
    pvtJson_Number(json, "recall", score->recall);
    pvtJson_EndObject(json);
}

static void WriteDirection(pvtJson* json, pvtVec3 direction)
{
    pvtJson_BeginArray(json, "direction");
    pvtJson_Number(json, NULL, direction.x);
    pvtJson_Number(json, NULL, direction.y);
    pvtJson_Number(json, NULL, direction.z);
    pvtJson_EndArray(json);
}

static void WriteView(pvtJson* json, const pvtViewScore* view)
{
    pvtJson_BeginObject(json, NULL);
    WriteDirection(json, view->direction);
    WriteQuads(json, "uniform", &view->uniform);
    WriteQuads(json, "small", &view->small);
    pvtJson_Number(json, "coverage", view->coverage);
    pvtJson_Number(json, "over_area", view->overArea);
    pvtJson_Number(json, "over_thickness", view->overThickness);
    pvtJson_EndObject(json);
}

static void WriteOccluder(pvtJson* json, const char* path, const pvtOccluderScore* score)
{
    pvtJson_BeginObject(json, NULL);
    pvtJson_String(json, "file", path);
    pvtJson_Integer(json, "triangles", (int64_t)score->triangleCount);
    WriteQuads(json, "uniform", &score->uniform);
    WriteQuads(json, "small", &score->small);
    pvtJson_Number(json, "coverage", score->coverage);
    pvtJson_Number(json, "over_area", score->overArea);
    pvtJson_Number(json, "over_thickness", score->overThickness);
    const pvtViewScore* worst = &score->views[score->worstView];
    pvtJson_BeginObject(json, "worst_view");
    WriteDirection(json, worst->direction);
    pvtJson_Number(json, "recall", worst->uniform.recall);
    pvtJson_EndObject(json);
    pvtJson_BeginArray(json, "per_view");
    for (size_t v = 0; v < score->viewCount; ++v) {
        WriteView(json, &score->views[v]);
    }
    pvtJson_EndArray(json);
    pvtJson_EndObject(json);
}

void pvtWriteScores(pvtJson* json, const pvtJudgement* judgement)
{
    const pvtEvaluation* evaluation = judgement->evaluation;
    pvtJson_BeginObject(json, NULL);
    pvtJson_String(json, "version", pvtGetVersion());
    pvtJson_BeginObject(json, "original");
    pvtJson_String(json, "file", judgement->original);
    pvtJson_Integer(json, "triangles", (int64_t)evaluation->originalTriangleCount);
    pvtJson_EndObject(json);
    pvtJson_Integer(json, "views", evaluation->options.views);
    pvtJson_Integer(json, "quads", evaluation->options.quads);
    pvtJson_Integer(json, "pixels", evaluation->options.pixels);
    pvtJson_Integer(json, "seed", (int64_t)evaluation->options.seed);
    pvtJson_BeginArray(json, "occluders");
    for (size_t i = 0; i < evaluation->count; ++i) {
        WriteOccluder(json, judgement->occluders[i], &evaluation->occluders[i]);
    }
    pvtJson_EndArray(json);
    pvtJson_EndObject(json);
}

void pvtWriteScoresJson(pvtOutput* output, const pvtJudgement* judgement)
{
    pvtJson json = pvtMakeJson(output);
    pvtWriteScores(&json, judgement);
}

static void PrintField(pvtOutput* output, const char* text)
{
    if (strpbrk(text, ",\"\r\n") == NULL) {
        pvtOutput_Print(output, "%s", text);
        return;
    }
    pvtOutput_Print(output, "\"");
    for (; *text != '\0'; ++text) {
        pvtOutput_Print(output, *text == '"' ? "\"\"" : "%c", *text);
    }
    pvtOutput_Print(output, "\"");
}

static void PrintNumber(pvtOutput* output, double number)
{
    char text[32];
    pvtPrintNumber(number, text);
    pvtOutput_Print(output, ",%s", text);
}

static void PrintQuads(pvtOutput* output, const pvtQuadScore* score)
{
    PrintNumber(output, score->precision);
    PrintNumber(output, score->recall);
    pvtOutput_Print(output, ",%llu,%llu,%llu", (unsigned long long)score->hidden,
                    (unsigned long long)score->lost, (unsigned long long)score->wrong);
}

void pvtWriteScoresCsv(pvtOutput* output, const pvtJudgement* judgement)
{
    pvtOutput_Print(output, "occluder,view,direction_x,direction_y,direction_z,uniform_precision,"
                            "uniform_recall,uniform_nt,uniform_pf,uniform_nf,small_precision,"
                            "small_recall,small_nt,small_pf,small_nf,coverage,over_area,"
                            "over_thickness\r\n");
    for (size_t i = 0; i < judgement->evaluation->count; ++i) {
        const pvtOccluderScore* score = &judgement->evaluation->occluders[i];
        for (size_t v = 0; v < score->viewCount; ++v) {
            const pvtViewScore* view = &score->views[v];
            PrintField(output, judgement->occluders[i]);
            pvtOutput_Print(output, ",%zu", v);
            PrintNumber(output, view->direction.x);
            PrintNumber(output, view->direction.y);
            PrintNumber(output, view->direction.z);
            PrintQuads(output, &view->uniform);
            PrintQuads(output, &view->small);
            PrintNumber(output, view->coverage);
            PrintNumber(output, view->overArea);
            PrintNumber(output, view->overThickness);
            pvtOutput_Print(output, "\r\n");
        }
    }
}
