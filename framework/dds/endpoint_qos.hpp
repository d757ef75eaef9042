/// Private to framework/dds: quality of service between the plain values that the rules judge and Cyclone's own form.
#pragma once

#include <dds/dds.h>

#include "framework/component/qos_match.hpp"

namespace kervan::dds {

/// Sets every policy of `qos`.
void set_endpoint_qos(dds_qos_t* to, const EndpointQos& qos);

/// Every policy of an endpoint, also of one of another process; what it does not say has the default of DDS.
EndpointQos endpoint_qos(const dds_qos_t* qos);

}  // namespace kervan::dds
