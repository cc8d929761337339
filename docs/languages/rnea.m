function tau = rnea(model, q, v, a, wrong_sign)
% Inverse dynamics by the recursive Newton-Euler algorithm, in Octave and MATLAB. To export the model:
%
%     graphdyn export ur5 --to model.m
%
% model: result of model.m; q, v, a: (n, 1). A fifth argument makes one sign wrong.
  s = 1 - 2 * (nargin > 4);
  n = model.n;
  ground = -model.base_rotation' * model.gravity;
  for j = 1:n
    i = model.parent(j);
    p = model.axis(:, j);
    slides = model.prismatic(j);
    if i == 0, w = zeros(3, 1); dw = w; acc = ground; else, w = omega(:, i); dw = alpha(:, i); acc = accel(:, i); end
    R = model.rotation(:, :, j);
    arm(:, j) = model.translation(:, j) + R * p * (slides * q(j));
    if ~slides, K = skew(p); R = R * (eye(3) + sin(q(j)) * K + (1 - cos(q(j))) * K^2); end
    acc = R' * (acc + cross(dw, arm(:, j)) + cross(w, cross(w, arm(:, j))));
    w = R' * w;
    if slides
      accel(:, j) = acc + a(j) * p + 2 * cross(w, v(j) * p);
      omega(:, j) = w;
      alpha(:, j) = R' * dw;
    else
      accel(:, j) = acc;
      omega(:, j) = w + v(j) * p;
      alpha(:, j) = R' * dw + a(j) * p + s * cross(w, v(j) * p);
    end
    w = omega(:, j); dw = alpha(:, j); c = model.center_of_mass(:, j); J = model.inertia(:, :, j);
    force(:, j) = model.mass(j) * (accel(:, j) + cross(dw, c) + cross(w, cross(w, c)));
    moment(:, j) = J * dw + cross(w, J * w) + cross(c, force(:, j));
    turn(:, :, j) = R;
  end
  tau = zeros(n, 1);
  for j = n:-1:1
    i = model.parent(j);
    if model.prismatic(j), tau(j) = model.axis(:, j)' * force(:, j); else, tau(j) = model.axis(:, j)' * moment(:, j); end
    if i > 0
      push = turn(:, :, j) * force(:, j);
      force(:, i) = force(:, i) + push;
      moment(:, i) = moment(:, i) + turn(:, :, j) * moment(:, j) + cross(arm(:, j), push);
    end
  end
end

function K = skew(x)
  K = [0, -x(3), x(2); x(3), 0, -x(1); -x(2), x(1), 0];
end
