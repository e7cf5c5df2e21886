for s in $(seq 1 64); do
  sample-surface --seed $s --samples 100k --environment 0.1,0.11,0.13 data/scenes/gummies.glb -o $s.cloud
  gather --seed $s --spp 12 --width 48 --height 48 --bssrdf directional-dipole --medium Cherry=data/media/cherry.json --medium Orange=data/media/orange.json --medium Lime=data/media/lime.json --environment 0.1,0.11,0.13 --view data/views/gummies/all.json $s.cloud data/scenes/gummies.glb -o gummies/$s.exr
done
compare --summarise gummies tests/golden/gummies
