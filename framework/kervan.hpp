/// Everything that a component's author needs.
#pragma once

#include "framework/component/component.hpp"
#include "framework/component/parameters.hpp"
#include "framework/component/ports.hpp"
#include "framework/component/qos.hpp"
#include "framework/component/request.hpp"
#include "framework/component/time.hpp"
#include "framework/geometry/angle.hpp"
#include "framework/geometry/pose2.hpp"
