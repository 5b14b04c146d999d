// The source with a known true image that `eigenlight stress` also uses.
#pragma once

#include "sequences/stress/analytic_source.h"
