% The experiment of benchmarks/sweep.py in GNU Octave; prints seconds a sample.
1;
steps = 2000; iterations = 11;
dt = 0.001; R = 0.2; B = 0.518; limit = 180; l1 = 0.1; l2 = 0.25; l3 = 0.25;
angle = linspace(0, 2 * pi, steps + 1);
desired = [10 * cos(angle); 10 * sin(angle); angle + pi / 2];
wheels = zeros(2, steps); past = zeros(3, steps + 1);
tic;
for iteration = 0:iterations - 1
  pose = [10; 0; pi / 2];
  errors = zeros(3, steps + 1);
  errors(:, 1) = desired(:, 1) - pose;
  before = zeros(3, 1);
  for k = 1:steps
    c = cos(pose(3)); s = sin(pose(3));
    if iteration > 0
      gain = [c, s, B; c, s, -B] / R;
      wheels(:, k) += gain * (l1 * past(:, k + 1) + l2 * errors(:, k) + l3 * before);
    end
    before = errors(:, k);
    fastest = max(abs(wheels(:, k)));
    if fastest > limit
      wheels(:, k) *= limit / fastest;
    end
    pose += dt * R / 2 * [c, c; s, s; 1 / B, -1 / B] * wheels(:, k);
    errors(:, k + 1) = desired(:, k + 1) - pose;
  end
  past = errors;
end
printf("%.9g\n", toc / (iterations * steps));
