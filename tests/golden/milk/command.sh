for s in $(seq 1 64); do
  sample-surface --seed $s --samples 100k --environment data/environments/sky.hdr data/scenes/milk.glb -o $s.cloud
  gather --seed $s --spp 12 --width 48 --height 48 --bssrdf directional-dipole --medium data/media/wholemilk.json --environment data/environments/sky.hdr --view data/views/milk/bowl.json $s.cloud data/scenes/milk.glb -o milk/$s.exr
done
compare --summarise milk tests/golden/milk
