for s in $(seq 1 64); do
  sample-surface --seed $s --samples 100k --environment 0.05,0.06,0.08 data/scenes/chess.glb -o $s.cloud
  gather --seed $s --spp 12 --width 48 --height 48 --bssrdf directional-dipole --medium Marble=data/media/marble.json --medium Jade=data/media/jade.json --environment 0.05,0.06,0.08 --view data/views/chess/board.json $s.cloud data/scenes/chess.glb -o chess/$s.exr
done
compare --summarise chess tests/golden/chess
