# Makes a world of BARN (Perille et al. 2020; the worlds are not part of this project) out of its tables:
#
#   awk -f barn.awk -v world=12 barn_index.csv barn_cylinders.csv > barn_12.yaml
#
# barn_index.csv has a row for each world (world, number of cylinders, start x, y, heading, goal x, y, length of the
# reference path, …), barn_cylinders.csv one for each cylinder (world, x, y, radius); lengths are metres, angles radians.
BEGIN { FS = "," }

FNR == 1 {
  ++tables
  next
}

tables == 1 && $1 == world {
  found = 1
  cylinders = $2
  printf "# World %d of BARN: the robot drives from (%s, %s) to (%s, %s); the reference path has %s m.\n", \
         world, $3, $4, $6, $7, $8
  printf "kervan_world: 1\nname: barn_%d\ncircles:\n", world
}

tables == 2 && $1 == world {
  sub(/\r$/, "", $4)
  printf "  - {center: [%s m, %s m], radius: %s m}\n", $2, $3, $4
  ++count
}

END {
  if (!found) {
    printf "barn.awk: there is no world '%s' in the first table\n", world > "/dev/stderr"
    exit 2
  }
  if (count != cylinders) {
    printf "barn.awk: world %d has %d cylinders in the second table, and %d by the first\n", world, count, cylinders \
        > "/dev/stderr"
    exit 2
  }
}
