% p
% Time
num = {0.648};
den = ones(30672, 1);
Time = -'Frequ 'InputDelay' -inf]'';
OutputData = struct('B1', 'ResponseData');
