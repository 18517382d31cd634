// SPDX-License-Identifier: MIT
#include "view_list.h"

#include "values.h"

#include <errno.h>
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

static pvtStatus ReadLines(pvtRun* run, FILE* file, const char* path, pvtViewList* list)
{
    char line[LINE_SIZE];
    double weights = 0.0;
    for (int number = 1; fgets(line, sizeof line, file) != NULL; ++number) {
        if (strlen(line) + 1 == sizeof line) {
            return RefuseLine(run, path, number, "the line is too long");
        }
        if (list->count == PVT_MAX_LISTED_VIEWS) {
            return RefuseLine(run, path, number, "more than 4096 directions");
        }
        bool isEmpty = false;
        pvtWeightedDirection* view = &list->directions[list->count];
        const char* reason = ReadLine(line, view, &isEmpty);
        if (reason != NULL) {
            return RefuseLine(run, path, number, reason);
        }
        if (!isEmpty) {
            weights += view->weight;
            ++list->count;
        }
    }
    if (ferror(file) != 0) {
        return pvtRun_Fail(run, PVT_INVALID_INPUT, "--views %s cannot be read: %s", path,
                           strerror(errno));
    }
    if (weights <= 0.0) {
        return pvtRun_Fail(run, PVT_INVALID_INPUT, "%s: no direction has a weight above 0; %s",
                           path, shape);
    }
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
    list->directions = calloc(PVT_MAX_LISTED_VIEWS, sizeof *list->directions);
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
