// SPDX-License-Identifier: MIT
// The page of `paravent evaluate --report`, bundled when the program was built: what comes before
// the data and what comes behind. Sizes are 0 in a build without Node.
#ifndef PVT_APP_REPORT_PAGE_H
#define PVT_APP_REPORT_PAGE_H

#include <stddef.h>

extern const unsigned char pvtReportHead[];
extern const size_t pvtReportHeadSize;
extern const unsigned char pvtReportTail[];
extern const size_t pvtReportTailSize;

#endif
