// SPDX-License-Identifier: MIT
#include "view_list.h"

#include "values.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 1024 };

static const char shape[] = "expected the direction to look along and its weight, four numbers "
                            "such as: 0 -1 0 2.5";

static pvtStatus RefuseLine(pvtRun* run, const char* path, int number, const char* reason)
{
    return pvtRun_Fail(run, PVT_INVALID_INPUT, "%s:%d: %s", path, number, reason);
}

// Null when the line is right; *isEmpty when it holds no direction.
static const char* ReadLine(char* line, pvtWeightedDirection* view, bool* isEmpty)
{
    static const char blanks[] = " \t\r\n";
    line[strcspn(line, "#")] = '\0';
    double numbers[4];
    int count = 0;
    char* rest = NULL;
    for (char* word = strtok_r(line, blanks, &rest); word != NULL;
         word = strtok_r(NULL, blanks, &rest)) {
        if (count == 4 || !pvtReadNumber(word, &numbers[count++])) {
            return shape;
        }
    }
    *isEmpty = count == 0;
    if (*isEmpty) {
        return NULL;
    }
    if (count < 4) {
        return shape;
    }
    if (numbers[0] == 0.0 && numbers[1] == 0.0 && numbers[2] == 0.0) {
        return "the direction 0 0 0 points nowhere";
    }
    if (numbers[3] < 0.0) {
        return "the weight is negative; it must be 0 or more";
    }
    *view = (pvtWeightedDirection){{numbers[0], numbers[1], numbers[2]}, numbers[3]};
    return NULL;
}

// Reads up to the end of the line or the file. Null when that went well; *isEnd when nothing was
// left to read.
static const char* TakeLine(FILE* file, char line[LINE_SIZE], bool* isEnd)
{
    size_t length = 0;
    int letter = fgetc(file);
    *isEnd = letter == EOF;
    for (; letter != EOF && letter != '\n'; letter = fgetc(file)) {
        if (letter == '\0') {
            return "this is not a text: it holds a byte of 0";
        }
        if (length + 1 == LINE_SIZE) {
            return "the line is too long";
        }
        line[length++] = (char)letter;
    }
    line[length] = '\0';
    return NULL;
}

// Directions of about length 1 and weights up to 1, so that whatever the numbers were, neither
// squares nor sums of them overflow.
static void ScaleViews(pvtViewList* list, double largestWeight)
{
    for (size_t i = 0; i < list->count; ++i) {
        pvtWeightedDirection* view = &list->directions[i];
        const pvtVec3 d = view->direction;
        const double length = fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z)));
        view->direction = (pvtVec3){d.x / length, d.y / length, d.z / length};
        view->weight /= largestWeight;
    }
}

static pvtStatus ReadLines(pvtRun* run, FILE* file, const char* path, pvtViewList* list)
{
    char line[LINE_SIZE];
    double largestWeight = 0.0;
    bool isEnd = false;
    for (int number = 1;; ++number) {
        const char* reason = TakeLine(file, line, &isEnd);
        if (reason == NULL && isEnd) {
            break;
        }
        pvtWeightedDirection view;
        bool isEmpty = false;
        if (reason == NULL) {
            reason = ReadLine(line, &view, &isEmpty);
        }
        if (reason == NULL && !isEmpty && list->count == PVT_MAX_VIEWS) {
            reason = "more than 4096 directions";
        }
        if (reason != NULL) {
            return RefuseLine(run, path, number, reason);
        }
        if (!isEmpty) {
            largestWeight = fmax(largestWeight, view.weight);
            list->directions[list->count++] = view;
        }
    }
    if (ferror(file) != 0) {
        return pvtRun_Fail(run, PVT_INVALID_INPUT, "--views %s cannot be read: %s", path,
                           strerror(errno));
    }
    if (largestWeight <= 0.0) {
        return pvtRun_Fail(run, PVT_INVALID_INPUT, "%s: no direction has a weight above 0; %s",
                           path, shape);
    }
    ScaleViews(list, largestWeight);
    return PVT_OK;
}

pvtStatus pvtReadViewList(pvtRun* run, const char* path, pvtViewList* list)
{
    *list = (pvtViewList){0};
    FILE* file = fopen(path, "r");
    if (file == NULL) {
        return pvtRun_Fail(run, PVT_INVALID_INPUT,
                           "--views %s: %s; it takes all, above or a file's name", path,
                           strerror(errno));
    }
    list->directions = calloc(PVT_MAX_VIEWS, sizeof *list->directions);
    const pvtStatus status = list->directions != NULL
                                 ? ReadLines(run, file, path, list)
                                 : pvtRun_Fail(run, PVT_OUT_OF_MEMORY, "out of memory");
    fclose(file);
    if (status != PVT_OK) {
        pvtViewList_Free(list);
    }
    return status;
}

void pvtViewList_Free(pvtViewList* list)
{
    free(list->directions);
    *list = (pvtViewList){0};
}
