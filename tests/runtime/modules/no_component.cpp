// A module without KERVAN_COMPONENT.
