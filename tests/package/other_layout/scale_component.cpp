#include "framework/kervan.hpp"
#include "shop_msgs/msg/Parcel.hpp"

namespace {

/// Weighs what it is told of.
class Scale final : public kervan::Component {
  kervan::Input<shop_msgs::msg::Parcel> parcel_{this, "parcel", kervan::qos::latched, &Scale::on_parcel, "Parcels."};
  double mass_ = 0.0;
  void on_parcel(const shop_msgs::msg::Parcel& parcel, kervan::Time) { mass_ += parcel.mass; }
};

}  // namespace

KERVAN_COMPONENT(Scale, "shop/scale", "Weighs parcels.")
