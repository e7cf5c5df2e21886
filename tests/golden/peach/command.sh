for s in $(seq 1 64); do
  sample-surface --seed $s --samples 100k --environment data/environments/studio.hdr data/scenes/peach.glb -o $s.cloud
  gather --seed $s --spp 12 --width 48 --height 48 --bssrdf directional-dipole --medium Peach=data/media/peach.json --medium Slice=data/media/peach_flesh.json --environment data/environments/studio.hdr --view data/views/peach/side.json $s.cloud data/scenes/peach.glb -o peach/$s.exr
done
compare --summarise peach tests/golden/peach
