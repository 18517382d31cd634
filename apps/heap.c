// SPDX-License-Identifier: MIT
// How jemalloc, where programs are linked with it, treats the heap. Stages fill and free tens of
// megabytes each, one after the other: pages that the system gave stay for the next stage, and are
// huge ones where the system has them, since a page that is touched first costs more than filling
// it.

extern const char* const malloc_conf;
const char* const malloc_conf = "thp:always,metadata_thp:auto,narenas:1,oversize_threshold:0,"
                                "dirty_decay_ms:-1,muzzy_decay_ms:-1";
