// SPDX-License-Identifier: MIT
#include "cancel.h"

#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>

// A signal handler is given no user data, so that this one flag must be global.
static atomic_bool stopRequested;

static void RequestStop(int number)
{
    (void)number;
    atomic_store(&stopRequested, true);
    // Whoever asks twice does not want to wait.
    (void)signal(SIGINT, SIG_DFL);
    (void)signal(SIGTERM, SIG_DFL);
}

void pvtWatchSignals(void)
{
    struct sigaction action = {.sa_handler = RequestStop, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
}

bool pvtIsStopRequested(void)
{
    return atomic_load(&stopRequested);
}
