// SPDX-License-Identifier: MIT
// SIGINT and SIGTERM ask the run to stop; a second one ends the process at once.
#ifndef PVT_APP_CANCEL_H
#define PVT_APP_CANCEL_H

#include <stdbool.h>

/// Also makes a closed pipe and a file size limit come back as errors of the write, so that they
/// are reported and nothing partial is left.
void pvtWatchSignals(void);
/// Safe on any thread.
bool pvtIsStopRequested(void);

#endif
