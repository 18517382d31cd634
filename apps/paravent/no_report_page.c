// SPDX-License-Identifier: MIT
// Stands in for the page in a build without Node.
#include "report_page.h"

const unsigned char pvtReportHead[] = {0};
const size_t pvtReportHeadSize = 0;
const unsigned char pvtReportTail[] = {0};
const size_t pvtReportTailSize = 0;
