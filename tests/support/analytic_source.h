// The source of known truth that `eigenlight stress` runs on, under the name that tests know.
#pragma once

#include "sequences/stress/analytic_source.h"
